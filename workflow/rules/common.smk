# The validated configuration and the few functions that read it; no other file does.
import os
from pathlib import Path

from snakemake.exceptions import WorkflowError

from tusqh.errors import TusqhError
from tusqh.geometry.packaged import PACKAGE
from tusqh.readers.formats import dimension_of, find_format
from provenance.claims import load_claims
from provenance.code import code_fingerprint, list_code
from tusqh.quality.system_libraries import describe_missing
from tusqh.settings.load import load_config
from tusqh.settings.section import to_plain
from studies.results_page import picture_name

BASE = Path(workflow.basedir)
SCRIPTS = set()
ENVIRONMENT = "../../environment.yml"
FIGURES = {
    2: ["field", "thresholds", "diagram", "curves", "antialias", "contaminant"],
    3: ["panels", "diagram", "curves", "temperature"],
}
THEORY = expand(
    "results/figures/{figure}.png",
    figure=["pinches", "pinches_in_series", "connecting_edges", "aliasing", "axis_gap"]
    + ["theorem_map", "theorem_windows", "theorem_space", "two_triangles", "wedge_islands"],
) + ["results/tables/theorem_contradictions.csv", "results/tables/gap_meshes.csv"]
PAGE_LINKS = {
    "explorer": "explorer.html",
    "mesh (VTU)": "mesh.vtu",
    "for MFEM": "export/mesh.mesh",
    "for Gmsh": "export/mesh.msh",
    "for Exodus": "export/mesh.exo",
    "for Abaqus": "export/mesh.inp",
    "certificate": "certificate.json",
    "persistence diagram": "diagram.csv",
    "all topologies": "topologies.csv",
    "bridges": "bridges.csv",
    "removed and filled": "features.csv",
    "simulation (ParaView)": "simulation/concentration.pvd",
}
PAPER_MODELS = {"chesapeake", "bearings", "dragon"}
PEERS = ["tusqh", "automesh", "pytetwild", "pyvista", "trimesh"]
EXPORTS = ["mesh.mesh", "mesh.msh", "mesh.exo", "mesh.inp"]

try:
    SETTINGS = load_config(
        [Path(path) for path in workflow.configfiles],
        config,
        given=workflow.config_settings.config,
    )
    CLAIMS = load_claims(
        BASE / "workflow/claims.yaml", BASE / "workflow/schemas/claims.schema.yaml"
    )
except TusqhError as error:
    raise WorkflowError(f"configuration error in {error}")

if describe_missing():
    logger.warning(describe_missing())

MODELS = SETTINGS.models
GEOMETRY = {name: model.geometry for name, model in MODELS.items()}
DIMENSION = {name: dimension_of(geometry) for name, geometry in GEOMETRY.items()}
SOLIDS = [name for name, dimension in DIMENSION.items() if dimension == 3]
SWEEP = {2: list(SETTINGS.sweep), 3: list(SETTINGS.sweep_3d)}
STUDY = SETTINGS.study.to_dict()
SNAPSHOTS = sorted(SETTINGS.snapshots)
SNAPSHOT_FILES = [f"concentration_{step:05d}.vtu" for step in SNAPSHOTS]

wildcard_constraints:
    model="|".join(MODELS),
    peer="|".join(PEERS),


def code_of(script):
    """Return the fingerprint of a rule's script and of all the project code that it imports."""
    SCRIPTS.add(f"workflow/scripts/{script}.py")
    return code_fingerprint(f"workflow/scripts/{script}.py", base=BASE)


onstart:
    for path in sorted(SCRIPTS):
        list_code(path, base=BASE, folder=Path("results/provenance/code"))


def settings_of(name):
    """Return a function that gives a rule a section or a key of its model, as plain values."""

    def settings(wildcards):
        model = MODELS[wildcards.model]
        owner = model if hasattr(model, name) else model.settings
        return to_plain(getattr(owner, name))

    return settings


def geometry_of(wildcards):
    """Return the geometry file of a model, none where it lies inside an installed package."""
    geometry = GEOMETRY[wildcards.model]
    return [] if geometry.startswith(PACKAGE) else geometry


def reader_of(wildcards):
    """Return the fingerprint of the module that reads a model's format."""
    reader = find_format(GEOMETRY[wildcards.model]).module
    return code_fingerprint(f"tusqh/readers/{reader}.py", base=BASE)


def source_of(path):
    """Return a file of the workflow, relative to where it runs, so that records are the same."""
    return os.path.relpath(BASE / "workflow" / path)


def any_of(dimension):
    """Return the pattern of the models of a dimension."""
    return "|".join(m for m, d in DIMENSION.items() if d == dimension) or "(?!)"


def figures_of_all_models():
    """Return the figures that every model has, by its dimension."""
    return [
        f"results/{model}/figures/{figure}.png"
        for model, dimension in DIMENSION.items()
        for figure in FIGURES[dimension]
    ]


def register_if_there():
    """Return the data register, none where the workflow runs in another folder."""
    register = "data_sources/register.csv"
    return [register] if Path(register).is_file() else []


def captions():
    """Return the texts of figures by name, as Snakemake's own report has them."""
    files = sorted((BASE / "workflow/report").glob("*.rst"))
    return {path.stem: path.read_text("utf-8").strip() for path in files}


def paper_targets():
    """Return the paper's page, the theory and all studies, where the paper's models are meshed."""
    if not PAPER_MODELS <= set(MODELS):
        return []
    stability = expand("results/{model}/figures/stability.png", model=MODELS)
    return ["results/page/results.md", *THEORY, *stability]
