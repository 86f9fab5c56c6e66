rule sample:
    input:
        **files("geometry"),
    output:
        **files("fractions"),
    params:
        grid=settings_of("grid"),
        window=settings_of("window"),
        sampling=settings_of("sampling"),
        threshold=threshold_of_placement,
    # Sums are of integers or within one thread, so the result does not depend on the number of threads.
    threads: 2
    priority: MODELS_FIRST
    script:
        "../scripts/sample.py"
