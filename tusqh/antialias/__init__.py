"""Pinches, clusters and the templates that resolve them."""
