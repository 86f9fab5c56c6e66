"""The volume mesh: connectivity, boundary, manifold checks, files."""
