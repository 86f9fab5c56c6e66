"""Simulate diffusion on the finished mesh with MFEM."""
