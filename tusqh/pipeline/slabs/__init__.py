"""Make one large mesh in slabs: the same mesh with less memory.

Modules: `limits` (what slabs cannot do, and how many are needed), `folder` (finished slabs on
disk), `fractions` (volume fractions), `cells` (kept cells and contacts), `elements` (elements and
their numbers), `certificate` (claims and their check), `mesh` (the whole run).
"""
