# What the results claim, and what they are for programs that know nothing of tusqh.


rule claims:
    input:
        tables=claim_tables(),
    output:
        table=report("results/tables/claims.csv", "../report/claims.rst", category="Tables"),
        record="results/provenance/claims.json",
        record_how="results/provenance/claims.how.json",
    params:
        code=code_of("claims"),
        claims=CLAIMS,
    log:
        "results/tables/logs/claims.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/claims.py"


rule crate:
    input:
        results=everything_else,
    output:
        crate="results/ro-crate-metadata.json",
        workflow=expand("results/workflow/{file}", file=WORKFLOW_FILES),
        record="results/provenance/crate.json",
        record_how="results/provenance/crate.how.json",
    params:
        code=code_of("crate"),
        workflow=workflow_fingerprint,
        about=ABOUT,
        register=sources,
    log:
        "results/tables/logs/crate.log",
    conda:
        ENVIRONMENT
    script:
        "../scripts/crate.py"
