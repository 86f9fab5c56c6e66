rule quality:
    input:
        **files("mesh", "facts"),
    output:
        **shown("elements", "verdict"),
    priority: MODELS_FIRST
    script:
        "../scripts/quality.py"
