"""The commands of `tusqh` that look at a whole workflow."""
