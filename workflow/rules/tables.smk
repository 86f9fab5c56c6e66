rule tables:
    input:
        **files_of_all_models("facts", "verdict", "amount", "defects", "verification"),
    output:
        summary=report("results/tables/summary.csv", "../report/summary.rst", category="Tables"),
        markdown="results/tables/summary.md",
        verification=report("results/tables/verification.csv", "../report/verification.rst", category="Tables"),
    script:
        "../scripts/tables.py"
