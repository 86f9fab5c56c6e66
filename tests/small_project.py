"""A small project: a plate in the plane and a ring in space, with their register."""

import hashlib
import shutil

import trimesh

# A plate with a round and a square hole; the path of the square is left open on purpose.
PLATE = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 80 40">
  <path d="M 0 0 H 80 V 40 H 0 Z
    M 30 20 A 10 10 0 1 0 10 20 A 10 10 0 1 0 30 20 Z
    M 50 10 V 30 H 70 V 10 H 50.5"/>
</svg>
"""
CONFIG = """models:
  plate:
    geometry: data_sources/plate.svg
    unit: mm
    grid: {cells: 32}
    threshold: 0.5
    fit: true
  ring:
    geometry: data_sources/ring.stl
    unit: mm
    grid: {cells: 12}
    target: {betti_0: 1, betti_1: 1}
    components: {min_cells: 2}
snapshots: [0, 2, 4, 8, 16, 32]
sweep_3d: [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0]
"""
REGISTER = """model,file,available,origin,url,licence,sha256,known_defects
plate,data_sources/plate.svg,yes,made for this project,,BSD-3-Clause,{plate},an open path
ring,data_sources/ring.stl,yes,made by this test,,CC0-1.0,{ring},two holes
"""
CODE = ["tusqh", "studies", "provenance", "workflow", "profiles"]
CODE += ["Snakefile", "CITATION.cff", "environment.yml", "README.md"]


def add_models(folder):
    """Put a configuration and the data of two small models into a folder."""
    (folder / "config").mkdir(parents=True)
    (folder / "config/config.yaml").write_text(CONFIG)
    (folder / "data_sources").mkdir()
    plate, ring = folder / "data_sources/plate.svg", folder / "data_sources/ring.stl"
    plate.write_text(PLATE)
    # These are enough triangles to make the ingested geometry larger than 1 MB.
    mesh = trimesh.creation.torus(10.0, 3.5, major_sections=250, minor_sections=120)
    mesh.update_faces([k not in (7, 90) for k in range(len(mesh.faces))])
    mesh.export(ring)
    digests = {p.stem: hashlib.sha256(p.read_bytes()).hexdigest() for p in (plate, ring)}
    (folder / "data_sources/register.csv").write_text(REGISTER.format(**digests))


def copy_code(repository, folder):
    """Copy the code into a folder, with the caches of numba and Python."""
    for name in CODE:
        copy = shutil.copytree if (repository / name).is_dir() else shutil.copy2
        copy(repository / name, folder / name)


def copy_results(built, folder):
    """Copy a project with its results, without Snakemake's internal files."""

    def unneeded(inside, names):
        own = {"log", "locks", "scripts"} if inside.endswith(".snakemake") else set()
        return own & set(names)

    shutil.copytree(built, folder, ignore=unneeded, dirs_exist_ok=True)
