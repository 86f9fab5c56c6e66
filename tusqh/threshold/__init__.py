"""Find the plateaus with a constant cell set, and choose a threshold among them."""
