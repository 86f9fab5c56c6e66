rule tables:
    input:
        facts=expand("results/{model}/facts.json", model=MODELS),
        verdicts=expand("results/{model}/verdict.csv", model=MODELS),
        amounts=expand("results/{model}/simulation/amount.csv", model=MODELS),
        defects=expand("results/{model}/defects.csv", model=MODELS),
        verifications=expand("results/{model}/verification.csv", model=MODELS),
    output:
        summary=report("results/tables/summary.csv", "../report/summary.rst", category="Tables"),
        markdown="results/tables/summary.md",
        verification=report("results/tables/verification.csv", "../report/verification.rst", category="Tables"),
        record="results/provenance/tables.json",
        record_how="results/provenance/tables.how.json",
    params:
        code=code_of("tables"),
    log:
        "results/tables/logs/tables.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/tables.py"
