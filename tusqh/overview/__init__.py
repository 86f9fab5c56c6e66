"""The overview: one page on all models, which opens from disk and links to all other results."""
