rule mesh:
    input:
        **files("geometry", "fractions", "selection"),
    output:
        **files("mesh", "facts"),
        **shown("features", "bridges", "changes", "certificate"),
    params:
        grid=settings_of("grid"),
        window=settings_of("window"),
        sampling=settings_of("sampling"),
        goal=settings_of("goal"),
        quality=settings_of("quality"),
        threshold=threshold_of_placement,
    priority: MODELS_FIRST
    script:
        "../scripts/mesh.py"


# Verify a model at many thresholds, which differ between outlines and solids.
if not IS_SPLIT:

    rule sweep_2d:
        input:
            **files("fractions", "selection"),
        output:
            meshes=sweep_meshes(2),
            **files("verification"),
        wildcard_constraints:
            model=any_of(2),
        params:
            thresholds=SWEEP[2],
        script:
            "../scripts/sweep.py"

    use rule sweep_2d as sweep_3d with:
        output:
            meshes=sweep_meshes(3),
            **files("verification"),
        wildcard_constraints:
            model=any_of(3),
        params:
            thresholds=SWEEP[3],

else:

    rule sweep_one:
        input:
            **files("fractions", "selection"),
        output:
            meshes=["results/{model}/sweep/{threshold}.vtu"],
            verification="results/{model}/sweep/{threshold}.csv",
        wildcard_constraints:
            threshold="|".join(str(t) for t in sorted({*SWEEP[2], *SWEEP[3]})),
        params:
            thresholds=lambda wildcards: [float(wildcards.threshold)],
        script:
            "../scripts/sweep.py"

    rule verification:
        input:
            rows=rows_of_sweep,
        output:
            **files("verification"),
        script:
            "../scripts/join_tables.py"


# Move the boundary of a mesh onto the geometry; the staircase stays as mesh.vtu.
rule fit:
    input:
        **files("geometry", "fractions", "selection", "mesh", "facts"),
    output:
        **files("fitted", "fit"),
        **shown("distances", "unfitted", "chains"),
        **files("patches"),
        timing="results/{model}/fit_timing.csv",
    wildcard_constraints:
        model="|".join(FITTED) or "(?!)",
    params:
        grid=settings_of("grid"),
        window=settings_of("window"),
        sampling=settings_of("sampling"),
        quality=settings_of("quality"),
        threshold=threshold_of_placement,
    priority: MODELS_FIRST
    script:
        "../scripts/fit.py"


# Merge grid cells inside the mesh that later steps take.
rule coarsen:
    input:
        **files("fractions", "mesh"),
        fitted=of_fitted("fitted"),
    output:
        **files("coarse", "coarse_mfem", "coarsening"),
    wildcard_constraints:
        model="|".join(COARSENED) or "(?!)",
    params:
        coarsening=settings_of("coarsening"),
    priority: MODELS_FIRST
    script:
        "../scripts/coarsen.py"


rule export:
    input:
        **files("geometry", "mesh"),
        fitted=of_fitted("fitted"),
        patches=of_fitted("patches"),
    output:
        **files(*EXPORTS),
        **shown("sets"),
    priority: MODELS_FIRST
    script:
        "../scripts/export.py"
