from tusqh.overview.files_read import FILES_READ, LINK_TITLES


# Make results/report/index.html, one page on all models; it shows the tables and figures given here.
rule overview:
    input:
        geometries=sorted({g for g in GEOMETRY.values() if not g.startswith(PACKAGE)}),
        **files_of_all_models(*FILES_READ),
        linked=list(files_of_all_models(*LINK_TITLES).values()),
        figures=[figure for model in MODELS for figure in figures_of(model)],
        tables=["results/tables/summary.csv", "results/tables/claims.csv"],
        shared=["results/figures/pinches.png"],
        register=register_if_there(),
    output:
        page="results/report/index.html",
    params:
        models=GEOMETRY,
        captions=captions(),
    script:
        "../scripts/overview.py"
