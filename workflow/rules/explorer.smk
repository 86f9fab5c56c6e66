from tusqh.explorer.files_read import FILES_OF_MATERIALS
from tusqh.explorer.files_read import FILES_READ as FILES_OF_EXPLORER


rule explorer:
    input:
        **files(*FILES_OF_EXPLORER),
        fitted=of_fitted("fitted"),
    output:
        **files("explorer"),
    params:
        geometry=settings_of("geometry"),
        up=settings_of("up"),
        settings=settings_of("settings"),
    priority: MODELS_FIRST
    script:
        "../scripts/explorer.py"


rule explorer_of_materials:
    input:
        **files(*FILES_OF_MATERIALS),
    output:
        **files("explorer"),
    wildcard_constraints:
        model=NAMES_OF_ASSEMBLIES,
    params:
        geometry=first_geometry_of,
        up=settings_of("up"),
    priority: MODELS_FIRST
    script:
        "../scripts/explorer_of_materials.py"
