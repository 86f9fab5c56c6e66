rule ingest:
    input:
        geometry=geometry_of,
    output:
        geometry="results/{model}/geometry.vtp",
        defects=report("results/{model}/defects.csv", "../report/defects.rst", category="{model}"),
        record="results/provenance/{model}/ingest.json",
        record_how="results/provenance/{model}/ingest.how.json",
    params:
        code=code_of("ingest"),
        reader=reader_of,
        source=settings_of("geometry"),
        image=settings_of("image"),
    log:
        "results/{model}/logs/ingest.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/ingest.py"
