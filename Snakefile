from snakemake.utils import min_version

min_version("9.0")


configfile: "config/config.yaml"


report: "workflow/report/workflow.rst"


include: "workflow/rules/common.smk"


rule all:
    input:
        "results/tables/summary.csv",
        "results/tables/summary.md",
        "results/tables/verification.csv",
        "results/tables/verdicts.csv",
        "results/tables/fit.csv",
        "results/tables/claims.csv",
        [figure for model in MODELS for figure in figures_of(model)],
        *files_of_all_models(*EXPORTS, "simulation", "defects", "explorer").values(),
        *files_of_coarsened_models("coarse", "coarse_mfem").values(),
        *files_of_assemblies(*EXPORTS, "certificate", "figure_materials", "explorer").values(),
        *files_of_models_in_slabs("slab_mesh", "certificate", "verdict", "defects").values(),
        expand(files("simulation")["simulation"], model=SIMULATED),
        "results/report/index.html",
        paper_targets(),
        "results/ro-crate-metadata.json",


# The models alone, without the paper's studies and the pages over all models.
rule models:
    input:
        *files_of_all_models("mesh", "certificate", "verdict", "explorer", *EXPORTS).values(),
        *files_of_fitted_models("fitted", "fit").values(),
        *files_of_coarsened_models("coarse", "coarse_mfem").values(),
        *files_of_assemblies("mesh", "certificate", "verdict", "explorer", *EXPORTS).values(),
        *files_of_models_in_slabs("slab_mesh", "certificate", "verdict").values(),


include: "workflow/rules/ingest.smk"
include: "workflow/rules/sample.smk"
include: "workflow/rules/topology.smk"
include: "workflow/rules/mesh.smk"
include: "workflow/rules/quality.smk"
include: "workflow/rules/simulate.smk"
include: "workflow/rules/materials.smk"
include: "workflow/rules/slabs.smk"
include: "workflow/rules/tables.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/theory.smk"
include: "workflow/rules/explorer.smk"
include: "workflow/rules/overview.smk"
include: "workflow/rules/studies.smk"
include: "workflow/rules/peers.smk"
include: "workflow/rules/results.smk"
include: "workflow/rules/provenance_inputs.smk"
include: "workflow/rules/provenance.smk"
include: "workflow/rules/slow_tests.smk"
include: "workflow/rules/resources.smk"
include: "workflow/rules/steps.smk"
