from tusqh.overview.page import template_fingerprint


# results/report/index.html: all models on one page.  Give more tables or figures to show more.
rule overview:
    input:
        geometries=sorted({g for g in GEOMETRY.values() if not g.startswith(PACKAGE)}),
        certificate=expand("results/{model}/certificate.json", model=MODELS),
        facts=expand("results/{model}/facts.json", model=MODELS),
        defects=expand("results/{model}/defects.csv", model=MODELS),
        candidates=expand("results/{model}/candidates.csv", model=MODELS),
        verdict=expand("results/{model}/verdict.csv", model=MODELS),
        verification=expand("results/{model}/verification.csv", model=MODELS),
        linked=expand("results/{model}/{file}", model=MODELS, file=PAGE_LINKS.values()),
        figures=figures_of_all_models(),
        tables=["results/tables/summary.csv", "results/tables/claims.csv"],
        shared=["results/figures/pinches.png"],
        register=register_if_there(),
    output:
        page="results/report/index.html",
        record="results/provenance/overview.json",
        record_how="results/provenance/overview.how.json",
    params:
        code=code_of("overview"),
        template=template_fingerprint(),
        models=GEOMETRY,
        links=PAGE_LINKS,
        captions=captions(),
    log:
        "results/report/logs/overview.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/overview.py"
