rule quality:
    input:
        **files("mesh", "facts"),
    output:
        **shown("elements", "verdict"),
    params:
        quality=settings_of("quality"),
    priority: MODELS_FIRST
    script:
        "../scripts/quality.py"
