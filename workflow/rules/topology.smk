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
        **files("fractions", "curves", "diagram"),
    output:
        **files("selection"),
        **shown("topologies", "candidates"),
    params:
        goal=settings_of("goal"),
        policy=settings_of("policy"),
    priority: MODELS_FIRST
    script:
        "../scripts/select.py"
