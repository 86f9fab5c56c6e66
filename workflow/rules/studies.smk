# Experiments on the configured models: what an analysis meets on them, and what depends on the grid.
rule suitability:
    input:
        fractions="results/{model}/fractions.npz",
        selection="results/{model}/selection.json",
    output:
        table="results/{model}/suitability.csv",
        record="results/provenance/{model}/suitability.json",
        record_how="results/provenance/{model}/suitability.how.json",
    params:
        code=code_of("suitability"),
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
    params:
        code=code_of("suitability_of_all_models"),
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
    params:
        code=code_of("figure_suitability"),
    log:
        "results/figures/logs/suitability.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/figure_suitability.py"


# One rule per dimension: their grids have other sizes.
for dimension in (2, 3):

    rule:
        name:
            f"placements_{dimension}d"
        input:
            geometry="results/{model}/geometry.vtp",
            selection="results/{model}/selection.json",
        output:
            placements="results/{model}/placements.csv",
            spread="results/{model}/orientation.csv",
            stability="results/{model}/stability.csv",
            recommended="results/{model}/recommended_grid.csv",
            record="results/provenance/{model}/placements.json",
            record_how="results/provenance/{model}/placements.how.json",
        wildcard_constraints:
            model=any_of(dimension),
        params:
            code=code_of("placements"),
            placements=STUDY["placements"],
            cells=STUDY[f"cells_{dimension}d"],
            window=settings_of("window"),
            sampling=settings_of("sampling"),
            goal=settings_of("goal"),
        log:
            "results/{model}/logs/placements.log",
        conda:
            ENVIRONMENT
        script:
            "../scripts/placements.py"


rule figure_stability:
    input:
        stability="results/{model}/stability.csv",
        selection="results/{model}/selection.json",
    output:
        figure=report("results/{model}/figures/stability.png", "../report/stability.rst", category="{model}"),
        record="results/provenance/{model}/figure_stability.json",
        record_how="results/provenance/{model}/figure_stability.how.json",
    params:
        code=code_of("figure_stability"),
    log:
        "results/{model}/logs/figure_stability.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/figure_stability.py"


rule placements_of_all_models:
    input:
        placements=expand("results/{model}/placements.csv", model=MODELS),
        spreads=expand("results/{model}/orientation.csv", model=MODELS),
        stabilities=expand("results/{model}/stability.csv", model=MODELS),
        recommended=expand("results/{model}/recommended_grid.csv", model=MODELS),
        selections=expand("results/{model}/selection.json", model=MODELS),
    output:
        spread=report("results/tables/orientation.csv", "../report/orientation.rst", category="Tables"),
        pooled=report("results/tables/orientation_pooled.csv", "../report/orientation.rst", category="Tables"),
        stability=report("results/tables/stability.csv", "../report/stability.rst", category="Tables"),
        recommended=report("results/tables/recommended_grids.csv", "../report/stability.rst", category="Tables"),
        record="results/provenance/placements_of_all_models.json",
        record_how="results/provenance/placements_of_all_models.how.json",
    params:
        code=code_of("placements_of_all_models"),
        models=list(MODELS),
    log:
        "results/tables/logs/placements.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/placements_of_all_models.py"


rule figure_orientation:
    input:
        spread="results/tables/orientation.csv",
        pooled="results/tables/orientation_pooled.csv",
    output:
        figure=report("results/figures/orientation.png", "../report/orientation.rst", category="Figures"),
        record="results/provenance/figure_orientation.json",
        record_how="results/provenance/figure_orientation.how.json",
    params:
        code=code_of("figure_orientation"),
    log:
        "results/figures/logs/orientation.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/figure_orientation.py"
