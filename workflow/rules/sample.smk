rule sample:
    input:
        geometry="results/{model}/geometry.vtp",
    output:
        fractions="results/{model}/fractions.npz",
        record="results/provenance/{model}/sample.json",
        record_how="results/provenance/{model}/sample.how.json",
    params:
        grid=of_model("grid", "window"),
        sampling=of_model("samples", "domain", "rule", "orientation"),
    log:
        "results/{model}/logs/sample.log",
    conda:
        ENVIRONMENT
    # Every query is summed by one thread, so the result does not depend on their number.
    threads: 2
    script:
        "../scripts/sample.py"
