# Tusqh beside other programs, on the same dirty surfaces; the optional ones: pip install ".[peers]".
rule peer:
    input:
        geometry="results/{model}/geometry.vtp",
        fractions="results/{model}/fractions.npz",
        selection="results/{model}/selection.json",
    output:
        row="results/{model}/peers/{peer}.csv",
        timing="results/{model}/peers/{peer}_timing.csv",
        record="results/provenance/{model}/peer_{peer}.json",
        record_how="results/provenance/{model}/peer_{peer}.how.json",
    wildcard_constraints:
        model=any_of(3),
    params:
        code=code_of("peer"),
        sampling=settings_of("sampling"),
        seconds=STUDY["seconds"],
    log:
        "results/{model}/logs/peer_{peer}.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/peer.py"


rule peers:
    input:
        rows=expand("results/{model}/peers/{peer}.csv", model=SOLIDS, peer=PEERS),
        timings=expand("results/{model}/peers/{peer}_timing.csv", model=SOLIDS, peer=PEERS),
    output:
        table=report("results/tables/peers.csv", "../report/peers.rst", category="Tables"),
        summary=report("results/tables/peers_summary.csv", "../report/peers.rst", category="Tables"),
        # Seconds: not the same twice, so in a file of their own.
        timing="results/tables/peers_timing.csv",
        record="results/provenance/peers.json",
        record_how="results/provenance/peers.how.json",
    params:
        code=code_of("peers"),
    log:
        "results/tables/logs/peers.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/peers.py"


rule figure_peers:
    input:
        table="results/tables/peers.csv",
    output:
        figure=report("results/figures/peers.png", "../report/peers.rst", category="Figures"),
        record="results/provenance/figure_peers.json",
        record_how="results/provenance/figure_peers.how.json",
    params:
        code=code_of("figure_peers"),
    log:
        "results/figures/logs/peers.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/figure_peers.py"
