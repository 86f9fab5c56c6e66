"""Outlines, triangle soups and images, whose defects are measured but never repaired."""
