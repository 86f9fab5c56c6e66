"""Run all stages for several materials, from files, parts or labels to a measured mesh.

Modules: `gather` (read the materials), `sample` (their fractions on one grid), `wishes` (thresholds
that give the wanted topology), `remarks` (materials without cells), `result` (tables and files),
`mesh` (all stages in one call).
"""
