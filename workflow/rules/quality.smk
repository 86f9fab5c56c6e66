rule quality:
    input:
        mesh="results/{model}/mesh.vtu",
        facts="results/{model}/facts.json",
    output:
        elements=report("results/{model}/elements.csv", "../report/elements.rst", category="{model}"),
        verdict=report("results/{model}/verdict.csv", "../report/verdict.rst", category="{model}"),
        record="results/provenance/{model}/quality.json",
        record_how="results/provenance/{model}/quality.how.json",
    params:
        code=code_of("quality"),
    log:
        "results/{model}/logs/quality.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/quality.py"
