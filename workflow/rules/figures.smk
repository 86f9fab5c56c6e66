rule figure_thresholds:
    input:
        geometry="results/{model}/geometry.vtp",
        fractions="results/{model}/fractions.npz",
    output:
        figure=report("results/{model}/figures/thresholds.png", "../report/thresholds.rst", category="{model}"),
        record="results/provenance/{model}/figure_thresholds.json",
        record_how="results/provenance/{model}/figure_thresholds.how.json",
    params:
        code=code_of("figure_thresholds"),
        policy=settings_of("policy"),
        panels=settings_of("panels"),
        unit=settings_of("unit"),
    log:
        "results/{model}/logs/figure_thresholds.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/figure_thresholds.py"


rule figure_diagram:
    input:
        diagram="results/{model}/diagram.csv",
        diagonal="results/{model}/diagonal.csv",
        selection="results/{model}/selection.json",
    output:
        figure=report("results/{model}/figures/diagram.png", "../report/diagram.rst", category="{model}"),
        record="results/provenance/{model}/figure_diagram.json",
        record_how="results/provenance/{model}/figure_diagram.how.json",
    params:
        code=code_of("figure_diagram"),
    log:
        "results/{model}/logs/figure_diagram.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/figure_diagram.py"


rule figure_curves:
    input:
        curves="results/{model}/curves.csv",
        topologies="results/{model}/topologies.csv",
        selection="results/{model}/selection.json",
    output:
        figure=report("results/{model}/figures/curves.png", "../report/curves.rst", category="{model}"),
        record="results/provenance/{model}/figure_curves.json",
        record_how="results/provenance/{model}/figure_curves.how.json",
    params:
        code=code_of("figure_curves"),
    log:
        "results/{model}/logs/figure_curves.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/figure_curves.py"


rule figure_field:
    input:
        geometry="results/{model}/geometry.vtp",
        fractions="results/{model}/fractions.npz",
    output:
        figure=report("results/{model}/figures/field.png", "../report/field.rst", category="{model}"),
        record="results/provenance/{model}/figure_field.json",
        record_how="results/provenance/{model}/figure_field.how.json",
    params:
        code=code_of("figure_field"),
        unit=settings_of("unit"),
    log:
        "results/{model}/logs/figure_field.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/figure_field.py"


rule figure_antialias:
    input:
        fractions="results/{model}/fractions.npz",
        mesh="results/{model}/mesh.vtu",
        selection="results/{model}/selection.json",
    output:
        figure=report("results/{model}/figures/antialias.png", "../report/antialias.rst", category="{model}"),
        record="results/provenance/{model}/figure_antialias.json",
        record_how="results/provenance/{model}/figure_antialias.how.json",
    params:
        code=code_of("figure_antialias"),
        unit=settings_of("unit"),
    log:
        "results/{model}/logs/figure_antialias.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/figure_antialias.py"


rule figure_contaminant:
    input:
        snapshots=expand("results/{{model}}/simulation/{file}", file=SNAPSHOT_FILES),
        table="results/{model}/simulation/amount.csv",
    output:
        figure=report("results/{model}/figures/contaminant.png", "../report/contaminant.rst", category="{model}"),
        record="results/provenance/{model}/figure_contaminant.json",
        record_how="results/provenance/{model}/figure_contaminant.how.json",
    params:
        code=code_of("figure_contaminant"),
        unit=settings_of("unit"),
    log:
        "results/{model}/logs/figure_contaminant.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/figure_contaminant.py"


rule figure_panels:
    input:
        geometry="results/{model}/geometry.vtp",
        meshes=expand("results/{{model}}/sweep/{threshold}.vtu", threshold=SWEEP[3]),
        verification="results/{model}/verification.csv",
    output:
        figure=report("results/{model}/figures/panels.png", "../report/panels.rst", category="{model}"),
        record="results/provenance/{model}/figure_panels.json",
        record_how="results/provenance/{model}/figure_panels.how.json",
    params:
        code=code_of("figure_panels"),
    log:
        "results/{model}/logs/figure_panels.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/figure_panels.py"


rule figure_temperature:
    input:
        snapshots=expand("results/{{model}}/simulation/{file}", file=SNAPSHOT_FILES),
        table="results/{model}/simulation/amount.csv",
    output:
        figure=report("results/{model}/figures/temperature.png", "../report/temperature.rst", category="{model}"),
        record="results/provenance/{model}/figure_temperature.json",
        record_how="results/provenance/{model}/figure_temperature.how.json",
    params:
        code=code_of("figure_temperature"),
    log:
        "results/{model}/logs/figure_temperature.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/figure_temperature.py"


rule figure_method:
    output:
        figure=report("results/figures/method.png", "../report/method.rst", category="Figures"),
        record="results/provenance/figure_method.json",
        record_how="results/provenance/figure_method.how.json",
    params:
        code=code_of("figure_method"),
    log:
        "results/figures/logs/method.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/figure_method.py"
