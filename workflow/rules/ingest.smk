rule ingest:
    input:
        geometry=geometry_of,
    output:
        **files("geometry", "reading"),
        **shown("defects"),
    params:
        reader=reader_of,
        source=settings_of("geometry"),
        image=settings_of("image"),
        lengths=settings_of("lengths"),
        unused=unused_settings_of,
    priority: MODELS_FIRST
    script:
        "../scripts/ingest.py"
