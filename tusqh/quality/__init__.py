"""Element metrics, surface checks and the verdict of analysis suitability."""
