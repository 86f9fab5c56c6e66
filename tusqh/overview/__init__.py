"""The overview: one page over all models, which opens from disk and links to all other results."""
