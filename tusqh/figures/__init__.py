"""Figures, each drawn from arrays and tables alone."""
