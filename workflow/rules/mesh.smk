rule mesh:
    input:
        fractions="results/{model}/fractions.npz",
        threshold="results/{model}/threshold.json",
    output:
        mesh="results/{model}/mesh.vtu",
        facts="results/{model}/mesh.json",
        features=report("results/{model}/features.csv", "../report/features.rst", category="{model}"),
        bridges=report("results/{model}/bridges.csv", "../report/bridges.rst", category="{model}"),
        certificate=report("results/{model}/certificate.json", "../report/certificate.rst", category="{model}"),
        record="results/provenance/{model}/mesh.json",
        record_how="results/provenance/{model}/mesh.how.json",
    log:
        "results/{model}/logs/mesh.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/mesh.py"


rule sweep:
    input:
        fractions="results/{model}/fractions.npz",
    output:
        meshes=expand("results/{{model}}/sweep/{threshold}.vtu", threshold=SWEEP),
        rows="results/{model}/verification.csv",
        record="results/provenance/{model}/sweep.json",
        record_how="results/provenance/{model}/sweep.how.json",
    params:
        policy=of_model("mixed_pinches", "bridges", "components", "holes", "voids"),
        thresholds=SWEEP,
    log:
        "results/{model}/logs/sweep.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/sweep.py"
