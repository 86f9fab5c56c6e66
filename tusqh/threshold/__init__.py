"""Plateaus of constant cell set and the choice of a threshold among them."""
