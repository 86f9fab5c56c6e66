from tusqh.explorer.files_read import FILES_READ as FILES_OF_EXPLORER


rule explorer:
    input:
        **files(*FILES_OF_EXPLORER),
    output:
        **files("explorer"),
    params:
        geometry=settings_of("geometry"),
        unit=settings_of("unit"),
        up=settings_of("up"),
        settings=settings_of("settings"),
    priority: MODELS_FIRST
    script:
        "../scripts/explorer.py"
