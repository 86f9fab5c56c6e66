"""Turn a geometry into a judged mesh: one module per stage, and `mesh`, which runs them all.

Each stage is a function of the results of the previous stages; the scripts of the workflow call the
same functions with files between them::

    ingest -> sample -> persistence -> select -> build -> judge
"""
