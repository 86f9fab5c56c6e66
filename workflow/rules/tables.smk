rule tables:
    input:
        **files_of_all_models("facts", "verdict", "amount", "defects", "verification"),
        fits=files_of_fitted_models("fit")["fit"],
        **files_of_every_model_in_slabs("facts", "verdict", "defects"),
        **files_of_every_assembly("materials", "verification", "verdict"),
        assembly_amount=expand(files("amount")["amount"], model=SIMULATED),
    output:
        summary=report("results/tables/summary.csv", "../report/summary.rst", category="Tables"),
        markdown="results/tables/summary.md",
        verification=report("results/tables/verification.csv", "../report/verification.rst", category="Tables"),
    script:
        "../scripts/tables.py"


rule verdicts:
    input:
        **files_of_all_models("facts", "verdict"),
        **files_of_every_model_in_slabs("facts", "verdict"),
        **files_of_every_assembly("materials", "verdict"),
        fits=files_of_fitted_models("fit")["fit"],
    output:
        verdicts=report("results/tables/verdicts.csv", "../report/verdicts.rst", category="Tables"),
    params:
        files=[*GEOMETRY.values(), *[model.geometry for model in IN_SLABS.values()]],
        files_of_assemblies=[", ".join(model.files) for model in ASSEMBLIES.values()],
    script:
        "../scripts/verdicts.py"


rule fit_table:
    input:
        **files_of_fitted_models("facts", "fit", "verdict"),
        timings=expand("results/{model}/fit_timing.csv", model=FITTED),
    output:
        fit=report("results/tables/fit.csv", "../report/fit.rst", category="Tables"),
        timing="results/tables/fit_timing.csv",
    script:
        "../scripts/fit_table.py"
