from tusqh.explorer.assets import assets_fingerprint


rule explorer:
    input:
        geometry="results/{model}/geometry.vtp",
        fractions="results/{model}/fractions.npz",
        curves="results/{model}/curves.csv",
        topologies="results/{model}/topologies.csv",
        diagram="results/{model}/diagram.csv",
        selection="results/{model}/selection.json",
        mesh="results/{model}/mesh.vtu",
        features="results/{model}/features.csv",
        bridges="results/{model}/bridges.csv",
        defects="results/{model}/defects.csv",
        elements="results/{model}/elements.csv",
        verdict="results/{model}/verdict.csv",
    output:
        page="results/{model}/explorer.html",
        record="results/provenance/{model}/explorer.json",
        record_how="results/provenance/{model}/explorer.how.json",
    params:
        code=code_of("explorer"),
        page=assets_fingerprint(),
        geometry=settings_of("geometry"),
        unit=settings_of("unit"),
        settings=settings_of("settings"),
    log:
        "results/{model}/logs/explorer.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/explorer.py"
