"""Make one large mesh in slabs: the same mesh with less memory.

Modules: `limits` (what slabs cannot do, and how many are needed), `folder` (finished slabs on
disk), `sample` and `fractions` (volume fractions), `cells` (kept cells and contacts), `windows`
(decisions on disk), `elements` (elements and their numbers), `write` (files), `found` (report and
certificate), `certificate` and `recheck` (claims and their check), `mesh` (the whole run), `steps`
(the same as jobs of the workflow).
"""
