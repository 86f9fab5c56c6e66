# Tusqh and other programs on the same dirty surfaces; pip install ".[peers]" installs the optional ones.
rule peer:
    input:
        **files("geometry", "fractions"),
        selection=ONE_THRESHOLD,
    output:
        row="results/{model}/peers/{peer}.csv",
        timing="results/{model}/peers/{peer}_timing.csv",
    wildcard_constraints:
        model=any_of(3),
    params:
        grid=settings_of("grid"),
        window=settings_of("window"),
        sampling=settings_of("sampling"),
        seconds=STUDY["seconds"],
    script:
        "../scripts/peer.py"


rule peers:
    input:
        rows=expand("results/{model}/peers/{peer}.csv", model=COMPARED, peer=PEERS),
        timings=expand("results/{model}/peers/{peer}_timing.csv", model=COMPARED, peer=PEERS),
    output:
        table=report("results/tables/peers.csv", "../report/peers.rst", category="Tables"),
        summary=report("results/tables/peers_summary.csv", "../report/peers.rst", category="Tables"),
        # Times differ from run to run, so they are in a separate file.
        timing="results/tables/peers_timing.csv",
    script:
        "../scripts/peers.py"


rule figure_peers:
    input:
        table="results/tables/peers.csv",
    output:
        figure=report("results/figures/peers.png", "../report/peers.rst", category="Figures"),
    script:
        "../scripts/figure_peers.py"
