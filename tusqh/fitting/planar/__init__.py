"""Fitting of quads: the boundary of a 2D mesh is moved onto an outline."""
