# Claims about the results, and the description of the results as an RO-Crate.


rule claims:
    input:
        tables=claim_tables(),
    output:
        table=report("results/tables/claims.csv", "../report/claims.rst", category="Tables"),
    params:
        claims=CLAIMS,
    script:
        "../scripts/claims.py"


rule crate:
    input:
        results=everything_else,
    output:
        crate="results/ro-crate-metadata.json",
        workflow=expand("results/workflow/{file}", file=WORKFLOW_FILES),
    params:
        workflow=workflow_fingerprint,
        about=ABOUT,
        register=sources,
    script:
        "../scripts/crate.py"
