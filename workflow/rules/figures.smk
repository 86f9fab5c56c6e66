# Figures of one model are drawn by few steps, since every step imports the libraries for drawing.
rule figures_of_topology:
    input:
        **files("diagram", "diagonal", "curves", "topologies", "selection"),
    output:
        **shown("figure_diagram", "figure_curves"),
    script:
        "../scripts/figures_of_topology.py"


rule figures_of_outline:
    input:
        **files("geometry", "fractions", "selection", "mesh", "amount"),
        snapshots=snapshots(),
    output:
        **shown("figure_field", "figure_thresholds", "figure_antialias", "figure_contaminant"),
    wildcard_constraints:
        model=any_of(2),
    params:
        panels=settings_of("panels"),
    script:
        "../scripts/figures_of_outline.py"


rule figures_of_solid:
    input:
        **files("geometry", "mesh", "verification", "amount"),
        fitted=of_fitted("fitted"),
        meshes=sweep_meshes(3),
        snapshots=snapshots(),
    output:
        **shown("figure_panels", "figure_section", "figure_temperature"),
    wildcard_constraints:
        model=any_of(3),
    params:
        geometry=settings_of("geometry"),
        up=settings_of("up"),
    script:
        "../scripts/figures_of_solid.py"


rule figure_fit:
    input:
        **files("geometry", "mesh", "fitted", "patches"),
    output:
        **shown("figure_fit", "figure_sets", "figure_jacobians"),
    wildcard_constraints:
        model="|".join(FITTED) or "(?!)",
    params:
        geometry=settings_of("geometry"),
        up=settings_of("up"),
    script:
        "../scripts/figure_fit.py"


rule figure_method:
    output:
        figure=report("results/figures/method.png", "../report/method.rst", category="Figures"),
    script:
        "../scripts/figure_method.py"
