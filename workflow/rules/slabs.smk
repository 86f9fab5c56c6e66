# Large models in slabs: every slab is sampled, meshed and written by a job of its own.

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
