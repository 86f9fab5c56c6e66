"""Draw the figures of the studies; the figures of a model are in `tusqh.figures`."""
