"""The explorer: one HTML file per model with a slider over the threshold."""
