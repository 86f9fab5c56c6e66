# Models of several materials: one step meshes, measures and certifies them.
rule materials:
    input:
        sources=sources_of_materials,
    output:
        **files("geometry", "mesh", "fractions", "elements", "verdict", "verification"),
        **files("changes", "prices"),
        **shown("materials", "pairs", "certificate"),
    wildcard_constraints:
        model=NAMES_OF_ASSEMBLIES,
    params:
        model=block_of_model,
        readers=readers_of_materials,
    priority: MODELS_FIRST
    script:
        "../scripts/materials.py"


use rule export as export_materials with:
    input:
        **files("mesh"),
    wildcard_constraints:
        model=NAMES_OF_ASSEMBLIES,


rule figure_materials:
    input:
        **files("mesh"),
    output:
        **shown("figure_materials"),
    wildcard_constraints:
        model=NAMES_OF_ASSEMBLIES,
    params:
        geometry=first_geometry_of,
        up=settings_of("up"),
    script:
        "../scripts/figure_materials.py"


use rule simulate as simulate_materials with:
    wildcard_constraints:
        model=NAMES_OF_ASSEMBLIES,
