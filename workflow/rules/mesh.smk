rule mesh:
    input:
        fractions="results/{model}/fractions.npz",
        threshold="results/{model}/threshold.json",
    output:
        mesh="results/{model}/mesh.vtu",
        facts="results/{model}/mesh.json",
        removed=report("results/{model}/removed.csv", "../report/removed.rst", category="{model}"),
        record="results/provenance/{model}/mesh.json",
        record_how="results/provenance/{model}/mesh.how.json",
    params:
        resolution=of_model("min_cells", "mixed_pinches"),
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
        resolution=of_model("min_cells", "mixed_pinches"),
        thresholds=SWEEP,
    log:
        "results/{model}/logs/sweep.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/sweep.py"
