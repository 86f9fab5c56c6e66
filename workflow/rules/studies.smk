# Studies of the configured models: contacts, suitability for analysis, and dependence on the grid.
rule contacts:
    input:
        **files_of_all_models("fractions", "curves"),
    output:
        table=report("results/tables/contacts.csv", "../report/contacts.rst", category="Tables"),
    params:
        models=list(MODELS),
        sweep=SWEEP,
    script:
        "../scripts/contacts.py"


rule suitability:
    input:
        **files("fractions"),
        selection=ONE_THRESHOLD,
    output:
        table="results/{model}/suitability.csv",
        iterations="results/{model}/suitability_iterations.csv",
    script:
        "../scripts/suitability.py"


rule suitability_of_all_models:
    input:
        tables=expand("results/{model}/suitability.csv", model=MODELS),
        iterations=expand("results/{model}/suitability_iterations.csv", model=MODELS),
    output:
        table=report("results/tables/suitability.csv", "../report/suitability.rst", category="Tables"),
        summary=report("results/tables/suitability_summary.csv", "../report/suitability.rst", category="Tables"),
        markdown="results/tables/suitability_summary.md",
        iterations=report("results/tables/suitability_iterations.csv", "../report/suitability_iterations.rst", category="Tables"),
    script:
        "../scripts/suitability_of_all_models.py"


rule figure_suitability:
    input:
        table="results/tables/suitability.csv",
    output:
        figure=report("results/figures/suitability.png", "../report/suitability.rst", category="Figures"),
    script:
        "../scripts/figure_suitability.py"


# What a topology costs with one threshold for the whole model, and with local changes.
rule scopes:
    input:
        **files("geometry", "fractions", "curves", "diagram"),
    output:
        table="results/{model}/scopes.csv",
    params:
        window=settings_of("window"),
        sampling=settings_of("sampling"),
        goal=settings_of("goal"),
        policy=settings_of("policy"),
    script:
        "../scripts/scopes.py"


rule scopes_of_all_models:
    input:
        tables=expand("results/{model}/scopes.csv", model=MODELS),
    output:
        table=report("results/tables/local_topology.csv", "../report/scopes.rst", category="Tables"),
        figure=report("results/figures/scopes.png", "../report/scopes.rst", category="Figures"),
    script:
        "../scripts/scopes_of_all_models.py"


rule placements_part:
    input:
        **files("geometry"),
        selection=ONE_THRESHOLD,
    output:
        placements="results/{model}/placements/{part}.csv",
    params:
        placements=STUDY["placements"],
        n_parts=len(PARTS),
        cells=cells_of_study,
        window=settings_of("window"),
        sampling=settings_of("sampling"),
    script:
        "../scripts/placements_part.py"


rule placements:
    input:
        **files("geometry"),
        selection=ONE_THRESHOLD,
        parts=parts_of_placements,
    output:
        placements="results/{model}/placements.csv",
        spread="results/{model}/orientation.csv",
        stability="results/{model}/stability.csv",
        recommended="results/{model}/recommended_grid.csv",
    params:
        placements=STUDY["placements"],
        cells=cells_of_study,
        window=settings_of("window"),
        sampling=settings_of("sampling"),
        goal=settings_of("goal"),
    script:
        "../scripts/placements.py"


rule figure_stability:
    input:
        stability="results/{model}/stability.csv",
        selection=ONE_THRESHOLD,
    output:
        figure=report("results/{model}/figures/stability.png", "../report/stability.rst", category="{model}"),
    script:
        "../scripts/figure_stability.py"


rule placements_of_all_models:
    input:
        placements=expand("results/{model}/placements.csv", model=MODELS),
        spreads=expand("results/{model}/orientation.csv", model=MODELS),
        stabilities=expand("results/{model}/stability.csv", model=MODELS),
        recommended=expand("results/{model}/recommended_grid.csv", model=MODELS),
        selection=expand(ONE_THRESHOLD, model=MODELS),
    output:
        spread=report("results/tables/orientation.csv", "../report/orientation.rst", category="Tables"),
        pooled=report("results/tables/orientation_pooled.csv", "../report/orientation.rst", category="Tables"),
        stability=report("results/tables/stability.csv", "../report/stability.rst", category="Tables"),
        recommended=report("results/tables/recommended_grids.csv", "../report/stability.rst", category="Tables"),
    params:
        models=list(MODELS),
    script:
        "../scripts/placements_of_all_models.py"


rule figure_orientation:
    input:
        spread="results/tables/orientation.csv",
        pooled="results/tables/orientation_pooled.csv",
    output:
        figure=report("results/figures/orientation.png", "../report/orientation.rst", category="Figures"),
    script:
        "../scripts/figure_orientation.py"


# A problem with a known solution on staircases and on fitted meshes.
rule heat:
    output:
        table=report("results/tables/heat.csv", "../report/heat.rst", category="Tables"),
        orders=report("results/tables/heat_orders.csv", "../report/heat.rst", category="Tables"),
        figure=report("results/figures/heat.png", "../report/heat.rst", category="Figures"),
    params:
        cells_2d=[12, 24, 48, 96],
        cells_3d=[8, 12, 16, 24],
    script:
        "../scripts/heat.py"


# Slow studies of fitting, with `study: {fit: true}`: how distances fall with the cell, and creases.
rule fit_convergence:
    output:
        table=report("results/tables/fit_convergence.csv", "../report/fit_convergence.rst", category="Tables"),
        orders=report("results/tables/fit_orders.csv", "../report/fit_convergence.rst", category="Tables"),
        figure=report("results/figures/fit_convergence.png", "../report/fit_convergence.rst", category="Figures"),
    params:
        surfaces=["sphere", "torus", "box"],
        cells=[12, 16, 24, 32],
    script:
        "../scripts/fit_convergence.py"


rule creases:
    output:
        table=report("results/tables/creases.csv", "../report/creases.rst", category="Tables"),
    params:
        solids=["cube", "cylinder", "plate", "two_boxes", "bracket", "gear"],
        rotations=20,
    script:
        "../scripts/creases.py"
