"""Measure speed and memory as ratios to named alternatives in the same run."""
