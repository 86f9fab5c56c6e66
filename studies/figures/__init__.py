"""Figures of the studies; those of every model are in `tusqh.figures`."""
