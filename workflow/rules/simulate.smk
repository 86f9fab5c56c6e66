rule simulate:
    input:
        mesh="results/{model}/mesh.vtu",
    output:
        collection="results/{model}/simulation/concentration.pvd",
        snapshots=expand("results/{{model}}/simulation/{file}", file=SNAPSHOT_FILES),
        table=report("results/{model}/simulation/amount.csv", "../report/amount.rst", category="{model}"),
        record="results/provenance/{model}/simulate.json",
        record_how="results/provenance/{model}/simulate.how.json",
    params:
        code=code_of("simulate"),
        simulation=settings_of("simulation"),
        unit=settings_of("unit"),
        steps=SNAPSHOTS,
    log:
        "results/{model}/logs/simulate.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/simulate.py"
