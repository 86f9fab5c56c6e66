"""Diffusion on the finished mesh with MFEM."""
