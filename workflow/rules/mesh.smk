rule mesh:
    input:
        fractions="results/{model}/fractions.npz",
        selection="results/{model}/selection.json",
    output:
        mesh="results/{model}/mesh.vtu",
        facts="results/{model}/facts.json",
        features=report("results/{model}/features.csv", "../report/features.rst", category="{model}"),
        bridges=report("results/{model}/bridges.csv", "../report/bridges.rst", category="{model}"),
        certificate=report("results/{model}/certificate.json", "../report/certificate.rst", category="{model}"),
        record="results/provenance/{model}/mesh.json",
        record_how="results/provenance/{model}/mesh.how.json",
    params:
        code=code_of("mesh"),
    log:
        "results/{model}/logs/mesh.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/mesh.py"


# One rule per dimension: both verify every model, at thresholds of their own.
for dimension in (2, 3):

    rule:
        name:
            f"sweep_{dimension}d"
        input:
            fractions="results/{model}/fractions.npz",
        output:
            meshes=expand("results/{{model}}/sweep/{threshold}.vtu", threshold=SWEEP[dimension]),
            verification="results/{model}/verification.csv",
            record="results/provenance/{model}/sweep.json",
            record_how="results/provenance/{model}/sweep.how.json",
        wildcard_constraints:
            model=any_of(dimension),
        params:
            code=code_of("sweep"),
            policy=settings_of("policy"),
            thresholds=SWEEP[dimension],
        log:
            "results/{model}/logs/sweep.log",
        conda:
            ENVIRONMENT
        script:
            "../scripts/sweep.py"


rule export:
    input:
        mesh="results/{model}/mesh.vtu",
    output:
        meshes=expand("results/{{model}}/export/{file}", file=EXPORTS),
        record="results/provenance/{model}/export.json",
        record_how="results/provenance/{model}/export.how.json",
    params:
        code=code_of("export"),
    log:
        "results/{model}/logs/export.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/export.py"
