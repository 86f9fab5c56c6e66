rule quality:
    input:
        **files("mesh", "facts"),
    output:
        **shown("elements", "verdict"),
    script:
        "../scripts/quality.py"
