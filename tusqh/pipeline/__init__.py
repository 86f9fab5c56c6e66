"""From a geometry to a judged mesh: one module per stage, and `mesh`, which runs them all.

Each stage is a function of what the stages before it returned; the scripts of the workflow call
the same functions with files between them::

    ingest -> sample -> persistence -> select -> build -> judge
"""
