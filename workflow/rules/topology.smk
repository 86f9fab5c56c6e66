rule persistence:
    input:
        fractions="results/{model}/fractions.npz",
    output:
        diagram=report("results/{model}/diagram.csv", "../report/diagram.rst", category="{model}"),
        diagonal="results/{model}/diagonal.csv",
        curves="results/{model}/curves.csv",
        record="results/provenance/{model}/persistence.json",
        record_how="results/provenance/{model}/persistence.how.json",
    params:
        code=code_of("persistence"),
    log:
        "results/{model}/logs/persistence.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/persistence.py"


rule select:
    input:
        fractions="results/{model}/fractions.npz",
        curves="results/{model}/curves.csv",
        diagram="results/{model}/diagram.csv",
    output:
        selection="results/{model}/selection.json",
        topologies=report("results/{model}/topologies.csv", "../report/topologies.rst", category="{model}"),
        candidates=report("results/{model}/candidates.csv", "../report/candidates.rst", category="{model}"),
        record="results/provenance/{model}/select.json",
        record_how="results/provenance/{model}/select.how.json",
    params:
        code=code_of("select"),
        goal=settings_of("goal"),
        policy=settings_of("policy"),
    log:
        "results/{model}/logs/select.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/select.py"
