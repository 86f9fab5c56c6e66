from tusqh.overview.files_read import FILES_READ, FILES_READ_OF_MATERIALS, LINK_TITLES, LINK_TITLES_OF_MATERIALS


# Make results/report/index.html, one page on all models; it shows the tables and figures given here.
rule overview:
    input:
        geometries=sorted({g for g in all_geometries() if not g.startswith(PACKAGE)}),
        **files_of_all_models(*FILES_READ),
        **files_of_every_assembly(*FILES_READ_OF_MATERIALS),
        linked=[
            *files_of_all_models(*LINK_TITLES).values(),
            *files_of_assemblies(*LINK_TITLES_OF_MATERIALS).values(),
        ],
        figures=[
            *[figure for model in MODELS for figure in figures_of(model)],
            *files_of_assemblies("figure_materials")["figure_materials"],
        ],
        fits=[path for paths in files_of_fitted_models("fit", "fitted").values() for path in paths],
        tables=["results/tables/summary.csv", "results/tables/fit.csv", "results/tables/claims.csv"],
        shared=["results/figures/pinches.png"],
        register=register_if_there(),
    output:
        page="results/report/index.html",
    params:
        # Models in slabs have a mesh and its certificate alone, and a row in the summary.
        models={name: list(model.files) for name, model in SETTINGS.models.items() if name not in IN_SLABS},
        of_materials=list(ASSEMBLIES),
        fitted=FITTED,
        captions=captions(),
    script:
        "../scripts/overview.py"
