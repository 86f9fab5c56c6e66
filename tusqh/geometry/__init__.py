"""Outlines, triangle soups and images, with their defects measured but never repaired."""
