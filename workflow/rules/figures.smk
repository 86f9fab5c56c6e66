rule figure_thresholds:
    input:
        **files("geometry", "fractions", "selection"),
    output:
        figure=figure_of_model("thresholds"),
    params:
        panels=settings_of("panels"),
        unit=settings_of("unit"),
    script:
        "../scripts/figure_thresholds.py"


rule figure_diagram:
    input:
        **files("diagram", "diagonal", "selection"),
    output:
        figure=figure_of_model("diagram"),
    script:
        "../scripts/figure_diagram.py"


rule figure_curves:
    input:
        **files("curves", "topologies", "selection"),
    output:
        figure=figure_of_model("curves"),
    script:
        "../scripts/figure_curves.py"


rule figure_field:
    input:
        **files("geometry", "fractions"),
    output:
        figure=figure_of_model("field"),
    params:
        unit=settings_of("unit"),
    script:
        "../scripts/figure_field.py"


rule figure_antialias:
    input:
        **files("fractions", "mesh", "selection"),
    output:
        figure=figure_of_model("antialias"),
    params:
        unit=settings_of("unit"),
    script:
        "../scripts/figure_antialias.py"


rule figure_contaminant:
    input:
        snapshots=snapshots(),
        **files("amount"),
    output:
        figure=figure_of_model("contaminant"),
    params:
        unit=settings_of("unit"),
    script:
        "../scripts/figure_contaminant.py"


rule figure_panels:
    input:
        **files("geometry", "verification"),
        meshes=sweep_meshes(3),
    output:
        figure=figure_of_model("panels"),
    script:
        "../scripts/figure_panels.py"


rule figure_temperature:
    input:
        snapshots=snapshots(),
        **files("amount"),
    output:
        figure=figure_of_model("temperature"),
    script:
        "../scripts/figure_temperature.py"


rule figure_method:
    output:
        figure=report("results/figures/method.png", "../report/method.rst", category="Figures"),
    script:
        "../scripts/figure_method.py"
