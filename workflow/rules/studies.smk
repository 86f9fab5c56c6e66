# Experiments on the configured models: what an analysis meets on them, and what depends on the grid.
rule suitability:
    input:
        fractions="results/{model}/fractions.npz",
        threshold="results/{model}/threshold.json",
    output:
        table="results/{model}/suitability.csv",
        record="results/provenance/{model}/suitability.json",
        record_how="results/provenance/{model}/suitability.how.json",
    log:
        "results/{model}/logs/suitability.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/suitability.py"


rule suitability_of_all_models:
    input:
        tables=expand("results/{model}/suitability.csv", model=MODELS),
    output:
        table=report("results/tables/suitability.csv", "../report/suitability.rst", category="Tables"),
        summary=report("results/tables/suitability_summary.csv", "../report/suitability.rst", category="Tables"),
        markdown="results/tables/suitability_summary.md",
        record="results/provenance/suitability_of_all_models.json",
        record_how="results/provenance/suitability_of_all_models.how.json",
    log:
        "results/tables/logs/suitability.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/suitability_of_all_models.py"


rule figure_suitability:
    input:
        table="results/tables/suitability.csv",
    output:
        figure=report("results/figures/suitability.png", "../report/suitability.rst", category="Figures"),
        record="results/provenance/figure_suitability.json",
        record_how="results/provenance/figure_suitability.how.json",
    log:
        "results/figures/logs/suitability.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/figure_suitability.py"
