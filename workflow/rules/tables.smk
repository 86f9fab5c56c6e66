rule tables:
    input:
        **files_of_all_models("facts", "verdict", "amount", "defects", "verification"),
        materials=files_of_assemblies("verification")["verification"],
    output:
        summary=report("results/tables/summary.csv", "../report/summary.rst", category="Tables"),
        markdown="results/tables/summary.md",
        verification=report("results/tables/verification.csv", "../report/verification.rst", category="Tables"),
    script:
        "../scripts/tables.py"


rule verdicts:
    input:
        **files_of_all_models("facts", "verdict"),
    output:
        verdicts=report("results/tables/verdicts.csv", "../report/verdicts.rst", category="Tables"),
    params:
        files=list(GEOMETRY.values()),
    script:
        "../scripts/verdicts.py"
