rule persistence:
    input:
        **files("fractions"),
    output:
        **shown("diagram"),
        **files("diagonal", "curves"),
    priority: MODELS_FIRST
    script:
        "../scripts/persistence.py"


rule select:
    input:
        **files("geometry", "fractions", "curves", "diagram"),
    output:
        **files("selection"),
        **shown("topologies", "candidates", "prices"),
        one_threshold=ONE_THRESHOLD,
    params:
        window=settings_of("window"),
        sampling=settings_of("sampling"),
        goal=settings_of("goal"),
        policy=settings_of("policy"),
    priority: MODELS_FIRST
    script:
        "../scripts/select.py"
