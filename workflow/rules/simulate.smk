rule simulate:
    input:
        **files("mesh"),
    output:
        **files("simulation"),
        snapshots=snapshots(),
        **shown("amount"),
    params:
        simulation=settings_of("simulation"),
        unit=settings_of("unit"),
        steps=SNAPSHOTS,
    script:
        "../scripts/simulate.py"
