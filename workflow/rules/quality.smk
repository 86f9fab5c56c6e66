rule quality:
    input:
        **files("mesh", "facts"),
        fitted=of_fitted("fitted"),
        fit=of_fitted("fit"),
    output:
        **shown("elements", "verdict"),
    params:
        quality=settings_of("quality"),
    priority: MODELS_FIRST
    script:
        "../scripts/quality.py"
