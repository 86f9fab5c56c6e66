"""Keep the topology of one threshold and the geometry of another.

Two squares are 0.3 apart, and the cells are half a unit wide.  One threshold for all cells opens
the gap, but also takes a layer of cells from the squares, whose area is 32:

>>> import tusqh
>>> squares = [[0, 0], [4, 0], [4, 4], [0, 4], [4.3, 0], [8.3, 0], [8.3, 4], [4.3, 4]]
>>> lines = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4]]
>>> wish = {"cells": 16, "placement": "corner", "betti": (2, 0)}
>>> one_threshold = tusqh.mesh((squares, lines), **wish, scope="global")
>>> str(one_threshold.report.measured), round(one_threshold.built.facts["volume"], 1)
('(2, 0, 0)', 22.6)

With local changes, the mesh has the cells of the threshold 1/2 except for eight cells in the gap:

>>> local = tusqh.mesh((squares, lines), **wish)
>>> str(local.report.measured), round(local.built.facts["volume"], 1)
('(2, 0, 0)', 32.3)
>>> local.built.changes[["change", "cells"]].values.tolist()
[['left out', 8]]
"""
