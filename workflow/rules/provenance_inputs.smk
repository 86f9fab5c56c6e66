# Functions that return the inputs of the rules of claims and of the crate.
import yaml

from provenance.code import workflow_digest
from provenance.register import read_register

CITATION = yaml.safe_load((BASE / "CITATION.cff").read_text("utf-8"))
ABOUT = {key: CITATION[key] for key in ("title", "version", "license", "date-released")}
ABOUT["authors"] = ", ".join(author["name"] for author in CITATION["authors"])
WORKFLOW_FILES = [
    "Snakefile",
    *sorted(
        path.relative_to(BASE).as_posix()
        for pattern in ("rules/*.smk", "scripts/*.py", "steps/*.py")
        for path in (BASE / "workflow").glob(pattern)
    ),
]
# Every configuration makes these tables; the others belong to the paper's models.
TABLES_OF_MODELS = {"results/tables/summary.csv", "results/tables/verification.csv"}


def claim_tables():
    """Return the tables that decide claims, as far as this configuration makes them."""
    tables = {claim["table"] for claim in CLAIMS if "table" in claim}
    if not paper_targets():
        tables &= TABLES_OF_MODELS
    return sorted(table for table in tables if Path(table).parts[1] in ["tables", *MODELS])


def everything_else(wildcards):
    """Return all that the workflow makes by default, but its description as an RO-Crate."""
    return [path for path in rules.all.input if path != rules.crate.output.crate]


def workflow_fingerprint(wildcards):
    """Return a digest of the workflow's files without comments."""
    return workflow_digest([BASE / file for file in WORKFLOW_FILES])


def sources(wildcards):
    """Return the rows of the register of data for the geometries of all models."""
    register = read_register(Path(), BASE)
    paths = {path for model in SETTINGS.models.values() for path in model.files}
    return {path: register[path] for path in sorted(paths) if path in register}
