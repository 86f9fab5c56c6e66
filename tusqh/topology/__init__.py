"""The paper's filtration, its persistence and the Betti numbers of meshes."""
