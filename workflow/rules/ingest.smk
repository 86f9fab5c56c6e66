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
    priority: MODELS_FIRST
    script:
        "../scripts/ingest.py"
