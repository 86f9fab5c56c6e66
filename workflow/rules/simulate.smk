rule simulate:
    input:
        **files("mesh"),
        fitted=of_fitted("fitted"),
    output:
        **files("simulation"),
        snapshots=snapshots(),
        **shown("amount"),
    params:
        simulation=settings_of("simulation"),
        diffusivities=diffusivities_of,
        steps=SNAPSHOTS,
    script:
        "../scripts/simulate.py"
