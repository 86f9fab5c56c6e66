"""The volume mesh: connectivity, boundary, manifold checks and files."""
