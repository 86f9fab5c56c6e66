# Large models in slabs: every slab is sampled, meshed and written by a job of its own.
from tusqh.grid.slabs import LEAST
from tusqh.sampling.memory import estimate_slab

# Bytes of a job of one slab, by which `slabs: auto` chooses their number before the geometry is read.
MEMORY_OF_SLAB = 1_000_000_000


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


SLAB_OF_FRACTIONS = "results/{model}/fractions_pieces/{slab}.npz"
SLAB_OF_ELEMENTS = "results/{model}/slabs/elements/{slab}.npz"
SLAB_OF_MESH = "results/{model}/mesh_pieces/{slab}.vtu"


use rule ingest as slab_ingest with:
    wildcard_constraints:
        model=NAMES_IN_SLABS,


rule slab_grid:
    input:
        **files("geometry"),
    output:
        **files("slab_grid"),
    wildcard_constraints:
        model=NAMES_IN_SLABS,
    params:
        settings=settings_of("settings"),
        slabs=slabs_of,
    threads: 2
    priority: MODELS_FIRST
    script:
        "../scripts/slab_grid.py"


rule slab_sample:
    input:
        **files("geometry", "slab_grid"),
    output:
        fractions=SLAB_OF_FRACTIONS,
    wildcard_constraints:
        model=NAMES_IN_SLABS,
    params:
        settings=settings_of("settings"),
    threads: 2
    priority: MODELS_FIRST
    script:
        "../scripts/slab_sample.py"


# Decisions depend on one another, so that one job makes all of them.
rule slab_contacts:
    input:
        **files("geometry", "slab_grid"),
        fractions=of_slabs(SLAB_OF_FRACTIONS),
    output:
        **files("slab_contacts"),
    wildcard_constraints:
        model=NAMES_IN_SLABS,
    params:
        settings=settings_of("settings"),
    priority: MODELS_FIRST
    script:
        "../scripts/slab_contacts.py"


rule slab_elements:
    input:
        **files("slab_grid", "slab_contacts"),
    output:
        elements=SLAB_OF_ELEMENTS,
    wildcard_constraints:
        model=NAMES_IN_SLABS,
    priority: MODELS_FIRST
    script:
        "../scripts/slab_elements.py"


# The number of a point in the whole mesh depends on the numbers of points of all slabs.
rule slab_piece:
    input:
        **files("slab_grid"),
        fractions=SLAB_OF_FRACTIONS,
        elements=of_slabs(SLAB_OF_ELEMENTS),
    output:
        piece=SLAB_OF_MESH,
    wildcard_constraints:
        model=NAMES_IN_SLABS,
    priority: MODELS_FIRST
    script:
        "../scripts/slab_piece.py"


rule slab_mesh:
    input:
        **files("geometry", "reading", "slab_grid"),
        fractions=of_slabs(SLAB_OF_FRACTIONS),
        pieces=of_slabs(SLAB_OF_MESH),
    output:
        **files("slab_mesh", "slab_fractions", "facts", "verdict"),
        **shown("certificate"),
    wildcard_constraints:
        model=NAMES_IN_SLABS,
    params:
        settings=settings_of("settings"),
    priority: MODELS_FIRST
    script:
        "../scripts/slab_mesh.py"
