"""Commands of `tusqh` that concern a whole workflow."""
