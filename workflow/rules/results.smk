# docs/results.md compares the paper's figures and claims with ours; its text is in ../report/results.
PAGE_SECTIONS = ["models", "theory", "studies", "scopes", "fit", "limits", "figures"]
PAGE_TABLES = [
    "results/tables/summary.csv",
    "results/tables/verification.csv",
    *expand(
        "results/tables/{table}.csv",
        table=["pinches", "aliasing", "theorem_windows", "theorem_space_windows", "theorem_contradictions"]
        + ["gap_meshes", "two_triangles", "wedge_grids"],
    ),
    "results/tables/contacts.csv",
    "results/tables/local_topology.csv",
    "results/tables/fit.csv",
    "results/tables/heat_orders.csv",
    "results/tables/orientation.csv",
    "results/tables/orientation_pooled.csv",
    "results/tables/recommended_grids.csv",
    "results/tables/suitability_summary.csv",
    "results/tables/suitability_iterations.csv",
    "results/tables/peers_summary.csv",
]
PAGE_FIGURES = [
    *expand("results/chesapeake/figures/{figure}.png", figure=FIGURES[2]),
    *expand("results/{model}/figures/{figure}.png", model=["bearings", "dragon"], figure=["panels", "diagram", "curves"]),
    *expand("results/{model}/figures/stability.png", model=["chesapeake", "bearings", "dragon"]),
    *expand("results/figures/{figure}.png", figure=["method", "orientation", "scopes", "heat", "suitability", "peers"]),
    *expand("results/{model}/figures/fit.png", model=[m for m in ("chesapeake", "bunny") if m in FITTED]),
    *[path for path in THEORY if path.endswith(".png")],
]
PAGE_PICTURES = [picture_name(figure) for figure in PAGE_FIGURES]


rule results_page:
    input:
        template=source_of("report/results.md.j2"),
        sections=expand(source_of("report/results/{section}.md.j2"), section=PAGE_SECTIONS),
        tables=PAGE_TABLES,
        figures=PAGE_FIGURES,
    output:
        page="results/page/results.md",
        pictures=expand("results/page/images/results/{picture}", picture=PAGE_PICTURES),
    script:
        "../scripts/results_page.py"


# This is not part of `all`, so that other configurations do not change the committed page.
rule docs:
    input:
        page="results/page/results.md",
        pictures=expand("results/page/images/results/{picture}", picture=PAGE_PICTURES),
    output:
        page="docs/results.md",
        pictures=expand("docs/images/results/{picture}", picture=PAGE_PICTURES),
    script:
        "../scripts/docs.py"
