rule sample:
    input:
        geometry="results/{model}/geometry.vtp",
    output:
        fractions="results/{model}/fractions.npz",
        record="results/provenance/{model}/sample.json",
        record_how="results/provenance/{model}/sample.how.json",
    params:
        code=code_of("sample"),
        grid=settings_of("grid"),
        window=settings_of("window"),
        sampling=settings_of("sampling"),
    log:
        "results/{model}/logs/sample.log",
    conda:
        ENVIRONMENT
    # Sums are of integers, or within one thread: the result does not depend on their number.
    threads: 2
    script:
        "../scripts/sample.py"
