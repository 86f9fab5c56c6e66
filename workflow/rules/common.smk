# The validated configuration and the functions that read it; other files do not read it.
import difflib
import os
import shlex
import subprocess
import sys
from pathlib import Path

from snakemake.exceptions import WorkflowError

# The folder of this checkout, also when another workflow uses this one as a module.
BASE = Path(os.fspath(workflow.current_basedir)).parents[1]
# Let scripts find the packages of the checkout, wherever Snakemake runs.
if str(BASE) not in sys.path:
    sys.path.insert(0, str(BASE))
FOLDERS = [folder for folder in os.environ.get("PYTHONPATH", "").split(os.pathsep) if folder]
if str(BASE) not in FOLDERS:
    os.environ.update(PYTHONPATH=os.pathsep.join([str(BASE), *FOLDERS]))

# Threads that wait leave the processor to other steps.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

from tusqh.compiled import compile_functions, is_compiled, write_bytecode
from tusqh.errors import TusqhError
from tusqh.files import RESULT_FILES
from tusqh.geometry.packaged import PACKAGE
from tusqh.grid.slabs import LEAST
from tusqh.readers.beside import files_beside
from tusqh.readers.formats import FORMATS, dimension_of, find_format
from provenance.claims import load_claims
from provenance.code import code_fingerprints, list_code
from tusqh.quality.system_libraries import describe_missing
from tusqh.sampling.memory import estimate_slab
from tusqh.settings.effect import find_without_effect
from tusqh.settings.load import load_config
from tusqh.settings.section import to_plain
from studies.pictures import picture_name

FIGURES = {
    2: ["field", "thresholds", "diagram", "curves", "antialias", "contaminant"],
    3: ["panels", "section", "diagram", "curves", "temperature"],
}
THEORY = expand(
    "results/figures/{figure}.png",
    figure=["pinches", "pinches_in_series", "connecting_edges", "aliasing", "axis_gap"]
    + ["theorem_map", "theorem_windows", "theorem_space", "two_triangles", "wedge_islands"],
) + ["results/tables/theorem_contradictions.csv", "results/tables/gap_meshes.csv"]
THEORY += ["results/tables/layers.csv"]
# Folders of results/ that do not belong to a model.
FOLDERS_OF_RESULTS = {"figures", "page", "provenance", "report", "tables", "tests", "workflow"}
# What the global scope selects: the paper's studies rest on one threshold for the whole model.
ONE_THRESHOLD = "results/{model}/one_threshold.json"
PAPER_MODELS = {"chesapeake", "bearings", "dragon"}
PEERS = ["tusqh", "tusqh_fitted", "automesh", "pytetwild", "pyvista", "trimesh"]
# How steps are started, see ../steps.
SOCKET = f".snakemake/steps-{os.getpid()}.socket"
START_STEP = shlex.join([sys.executable, "-I", "-S", os.fspath(BASE / "workflow/steps/start.py"), SOCKET])
# Steps that lead to a mesh have priority, so that the first models are ready early.
MODELS_FIRST = 1
EXPORTS = ["export_mfem", "export_gmsh", "export_exodus", "export_abaqus"]

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
    raise WorkflowError(f"configuration error: {error}")

if describe_missing():
    logger.warning(describe_missing())

# Models of one material, in one piece or in slabs (rules/slabs.smk), and of several (rules/materials.smk).
IN_SLABS = {name: m for name, m in SETTINGS.models.items() if m.settings.memory.slabs is not None}
MODELS = {name: m for name, m in SETTINGS.models.items() if not m.has_several_materials and name not in IN_SLABS}
ASSEMBLIES = {name: m for name, m in SETTINGS.models.items() if m.has_several_materials}
# Models of several materials that have diffusivities of their own are simulated.
SIMULATED = [n for n, m in ASSEMBLIES.items() if any(p.diffusivity for p in m.list_of_materials)]
NAMES_OF_ASSEMBLIES = "|".join(ASSEMBLIES) or "(?!)"
NAMES_IN_SLABS = "|".join(IN_SLABS) or "(?!)"
for name, model in IN_SLABS.items():
    if find_format(model.geometry).kind != "surface":
        raise WorkflowError(
            f"models.{name}.slabs: found {model.geometry}, expected a surface in space; leave out `slabs`"
        )
# Models whose boundary is fitted; later steps take the fitted mesh.
FITTED = [name for name, model in MODELS.items() if model.settings.fitting.fit]
# Models of which a coarse mesh is made as well.
COARSENED = [name for name, model in MODELS.items() if model.settings.coarsening.coarsen]
GEOMETRY = {name: model.geometry for name, model in MODELS.items()}
DIMENSION = {name: dimension_of(geometry) for name, geometry in GEOMETRY.items()}
SOLIDS = [name for name, dimension in DIMENSION.items() if dimension == 3]
SWEEP = {2: list(SETTINGS.sweep), 3: list(SETTINGS.sweep_3d)}
STUDY = SETTINGS.study.to_dict()
# Whether thresholds and placements are jobs of their own, and the parts of the placements.
IS_SPLIT = SETTINGS.split > 1
PARTS = range(min(SETTINGS.split, STUDY["placements"]))
COMPARED = SOLIDS if SETTINGS.study.peers is None else list(SETTINGS.study.peers)
if not set(COMPARED) <= set(SOLIDS):
    raise WorkflowError(f"study.peers: found {', '.join(COMPARED)}, expected 3D models: {', '.join(SOLIDS)}")
SNAPSHOTS = sorted(SETTINGS.snapshots)
# Bytes of a job of one slab, by which `slabs: auto` chooses their number before the geometry is read.
MEMORY_OF_SLAB = 1_000_000_000

wildcard_constraints:
    model="|".join(MODELS) or "(?!)",
    peer="|".join(PEERS),
    part=r"\d+",
    slab=r"\d{4}",


def files(*names):
    """Return files of a model by name, as `tusqh.files` lists them."""
    return {name: f"results/{{model}}/{RESULT_FILES[name].path}" for name in names}


def files_of_all_models(*names):
    """Return files of all models by name, in the order of the models."""
    return {name: expand(path, model=MODELS) for name, path in files(*names).items()}


def files_of_assemblies(*names):
    """Return files of all models of several materials by name."""
    return {name: expand(path, model=ASSEMBLIES) for name, path in files(*names).items()}


def files_of_every_assembly(*names):
    """Return the same files as inputs beside those of the models of one material."""
    return {f"assembly_{name}": paths for name, paths in files_of_assemblies(*names).items()}


def shown(*names):
    """Return files of a model by name, as outputs that Snakemake's report shows."""
    return {
        name: report(path, f"../report/{name.removeprefix('figure_')}.rst", category="{model}")
        for name, path in files(*names).items()
    }


def files_of_models_in_slabs(*names):
    """Return files of all models in slabs by name."""
    return {name: expand(path, model=IN_SLABS) for name, path in files(*names).items()}


def files_of_every_model_in_slabs(*names):
    """Return the same files as inputs beside those of the models in one piece."""
    return {f"slabs_{name}": paths for name, paths in files_of_models_in_slabs(*names).items()}


def of_fitted(name):
    """Return a function that gives a rule a file of the fit, in a list; empty without a fit."""

    def file_of(wildcards):
        is_fitted = wildcards.model in FITTED
        return expand(files(name)[name], model=wildcards.model) if is_fitted else []

    file_of.reads = name
    return file_of


def files_of_fitted_models(*names):
    """Return files of all fitted models by name."""
    return {name: expand(path, model=FITTED) for name, path in files(*names).items()}


def files_of_coarsened_models(*names):
    """Return files of all models with a coarse mesh by name."""
    return {name: expand(path, model=COARSENED) for name, path in files(*names).items()}


def sweep_meshes(dimension):
    """Return the meshes of the sweep, one for each threshold of this dimension."""
    return [f"results/{{model}}/sweep/{threshold}.vtu" for threshold in SWEEP[dimension]]


def rows_of_sweep(wildcards):
    """Return the tables of a model's sweep, one for each threshold, where these are separate jobs."""
    sweep = SWEEP[DIMENSION[wildcards.model]]
    return expand("results/{model}/sweep/{threshold}.csv", model=wildcards.model, threshold=sweep)


def parts_of_placements(wildcards):
    """Return the tables of a model's placements, one for each part; none where one job does all."""
    return expand("results/{model}/placements/{part}.csv", model=wildcards.model, part=PARTS) if IS_SPLIT else []


def snapshots():
    """Return the snapshots of the simulation."""
    return [f"results/{{model}}/simulation/concentration_{step:05d}.vtu" for step in SNAPSHOTS]


def settings_of(name):
    """Return a function that gives a rule a section or a key of its model, as plain values."""

    def settings(wildcards):
        model = SETTINGS.models[wildcards.model]
        owner = model if hasattr(model, name) else model.settings
        return to_plain(getattr(owner, name))

    return settings


def unused_settings_of(wildcards):
    """Return a sentence for each setting of a model that has no effect on its geometry."""
    model = SETTINGS.models[wildcards.model]
    return list(find_without_effect(model, find_format(model.geometry).kind))


def threshold_of_placement(wildcards):
    """Return the threshold for which the grid of a model is placed; no other step depends on it."""
    settings = MODELS[wildcards.model].settings
    return settings.goal.threshold if settings.grid.placement == "auto" else None


def cells_of_study(wildcards):
    """Return the sizes of the grids on which a model is placed at random."""
    return STUDY[f"cells_{DIMENSION[wildcards.model]}d"]


def geometry_of(wildcards):
    """Return the geometry file of a model with the files beside it; none in an installed package."""
    return with_files_beside([SETTINGS.models[wildcards.model].geometry])


def with_files_beside(geometries):
    """Return geometry files, but those of packages, and the files that are read with them."""
    own = [file for file in geometries if not file.startswith(PACKAGE)]
    beside = [os.fspath(other) for file in own for other in files_beside(Path(file))]
    return list(dict.fromkeys([*own, *beside]))


def all_geometries():
    """Return the geometry files of all models, of one material or of several."""
    return [file for model in SETTINGS.models.values() for file in model.files]


def reader_of(wildcards):
    """Return the fingerprint of the module that reads a model's format."""
    reader = find_format(SETTINGS.models[wildcards.model].geometry).module
    return FINGERPRINTS[f"tusqh/readers/{reader}.py"]


def diffusivities_of(wildcards):
    """Return the diffusivities that a model's materials have, by name."""
    materials = SETTINGS.models[wildcards.model].list_of_materials
    return {m.name: m.diffusivity for m in materials if m.diffusivity is not None}


def block_of_model(wildcards):
    """Return the settings of a model, as plain values."""
    return to_plain(SETTINGS.models[wildcards.model])


def sources_of_materials(wildcards):
    """Return the geometry files of a model of several materials with the files beside them."""
    return with_files_beside(ASSEMBLIES[wildcards.model].files)


def first_geometry_of(wildcards):
    """Return the first geometry file of a model of several materials, whose format has an upright axis."""
    return ASSEMBLIES[wildcards.model].files[0]


def readers_of_materials(wildcards):
    """Return the fingerprints of the modules that read the formats of several materials."""
    readers = {find_format(f).module for f in ASSEMBLIES[wildcards.model].files}
    return [FINGERPRINTS[f"tusqh/readers/{reader}.py"] for reader in sorted(readers)]


def source_of(path):
    """Return a file of the workflow relative to the working folder, so that records agree."""
    return os.path.relpath(BASE / "workflow" / path)


def any_of(dimension):
    """Return the pattern of the models of a dimension."""
    return "|".join(m for m, d in DIMENSION.items() if d == dimension) or "(?!)"


def figures_of(model):
    """Return the figures of a model, which depend on its dimension."""
    figures = [*(["fit", "sets", "jacobians"] if model in FITTED else []), *FIGURES[DIMENSION[model]]]
    return [f"results/{model}/figures/{figure}.png" for figure in figures]


def record_of(step):
    """Return the record of a step, without suffix, and its log: named after script and wildcards."""
    others = [f"{{{wildcard}}}" for wildcard in sorted(step.wildcard_names - {"model"})]
    name = "_".join([Path(step.script).stem, *others])
    if "model" in step.wildcard_names:
        return f"results/provenance/{{model}}/{name}", f"results/{{model}}/logs/{name}.log"
    return f"results/provenance/{name}", f"results/tables/logs/{name}.log"


def hint_at_models(targets):
    """Warn of targets like results/torux/mesh.vtu, whose model is not in the configuration."""
    for target in targets:
        folder, *rest = Path(target).parts[1:] or [""]
        if target.startswith("results/") and rest and folder not in {*SETTINGS.models, *FOLDERS_OF_RESULTS}:
            near = difflib.get_close_matches(folder, SETTINGS.models, n=1)
            hint = f"did you mean '{near[0]}'? The" if near else "the"
            logger.warning(
                f"{target}: there is no model '{folder}'; {hint} models are {', '.join(SETTINGS.models)}"
            )


def register_if_there():
    """Return the data register, none where the workflow runs in another folder."""
    register = "data_sources/register.csv"
    return [register] if Path(register).is_file() else []


def captions():
    """Return the captions of figures by name, as in Snakemake's own report."""
    files = sorted((BASE / "workflow/report").glob("*.rst"))
    return {path.stem: path.read_text("utf-8").strip() for path in files}


def paper_targets():
    """Return the paper's page, the theory and all studies, where the paper's models are meshed."""
    if not PAPER_MODELS <= set(MODELS):
        return []
    stability = expand("results/{model}/figures/stability.png", model=MODELS)
    slow = ["results/tables/fit_convergence.csv", "results/tables/creases.csv"] if STUDY["fit"] else []
    return ["results/page/results.md", *THEORY, *stability, *slow]


def many_steps_here():
    """Return whether a process with all imports saves time: for many steps on this machine.

    Libraries of macOS do not survive a fork.
    """
    if not (workflow.local_exec and sys.platform == "linux") or "COVERAGE_PROCESS_START" in os.environ:
        return False
    return sum(bool(job.rule.script) for job in workflow.dag.needrun_jobs()) >= 20


def serve_steps():
    """Start that process, which ends when this one does, since that closes the pipe."""
    one_thread = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL")}
    command = [sys.executable, os.fspath(BASE / "workflow/steps/serve.py"), SOCKET]
    subprocess.Popen(command, stdin=subprocess.PIPE, env=os.environ | one_thread)


def slabs_of(wildcards):
    """Return the number of slabs of a model."""
    model = SETTINGS.models[wildcards.model]
    wanted = model.settings.memory.slabs
    if wanted != "auto":
        return wanted
    n_cells = cells_of(model, 3)
    most = max(1, round(n_cells ** (1 / 3)) // LEAST)
    return next((n for n in range(1, most) if estimate_slab(n_cells, n_cells, n) <= MEMORY_OF_SLAB), most)


def of_slabs(path):
    """Return a function that gives a rule one file for every slab of its model."""

    def paths(wildcards):
        slabs = [f"{number:04d}" for number in range(slabs_of(wildcards))]
        return expand(path, model=wildcards.model, slab=slabs)

    return paths
