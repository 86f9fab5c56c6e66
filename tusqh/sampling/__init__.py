"""Winding numbers and the volume fractions of all grid cells."""
