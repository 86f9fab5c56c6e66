# Tests that take minutes, such as killing the workflow 20 times, are not part of `all`.


rule slow_tests:
    output:
        "results/tests/slow.xml",
    params:
        tests=source_of("../tests"),
    log:
        "results/tests/logs/slow.log",
    conda:
        "../../environment.yml"
    threads: 2
    shell:
        "python -m pytest -v -m slow --junitxml {output} {params.tests} >{log} 2>&1"
