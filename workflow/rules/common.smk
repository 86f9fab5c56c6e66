# The validated configuration and the few functions that read it; no other file does.
from pathlib import Path

from snakemake.exceptions import WorkflowError

from tusqh.config import load_config
from tusqh.errors import TusqhError
from tusqh.geometry.files import PACKAGE, dimension_of
from tusqh.quality.system_libraries import describe_missing

ENVIRONMENT = "../../environment.yml"
FIGURES = ["thresholds", "diagram", "antialias", "contaminant"]

try:
    SETTINGS = load_config(
        [Path(path) for path in workflow.configfiles],
        Path(workflow.basedir) / "workflow/schemas/config.schema.yaml",
        config,
    )
except TusqhError as error:
    raise WorkflowError(f"configuration error in {error}")

if describe_missing():
    logger.warning(describe_missing())

MODELS = SETTINGS["models"]
SWEEP = SETTINGS["sweep"]
SNAPSHOTS = sorted(SETTINGS["snapshots"])
SNAPSHOT_FILES = [f"concentration_{step:05d}.vtu" for step in SNAPSHOTS]

wildcard_constraints:
    model="|".join(MODELS),


def of_model(*keys):
    """Return a function that gives a rule those settings of its model that are set."""

    def settings(wildcards):
        return {key: MODELS[wildcards.model][key] for key in keys if key in MODELS[wildcards.model]}

    return settings


def geometry_of(wildcards):
    """Return the geometry file of a model, none where it lies inside an installed package."""
    geometry = MODELS[wildcards.model]["geometry"]
    return [] if geometry.startswith(PACKAGE) else geometry
