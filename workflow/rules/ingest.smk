rule ingest:
    input:
        geometry=geometry_of,
    output:
        **files("geometry"),
        **shown("defects"),
    params:
        reader=reader_of,
        source=settings_of("geometry"),
        image=settings_of("image"),
    script:
        "../scripts/ingest.py"
