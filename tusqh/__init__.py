"""Volume-fraction quad and hex meshes with a chosen topology, from geometry nobody repaired."""

__version__ = "0.1.0"
