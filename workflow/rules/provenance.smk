# What the results claim, and what they are for programs that know nothing of tusqh.


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
