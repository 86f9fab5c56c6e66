"""Draw figures from arrays and tables alone."""
