"""A small project of one model in the plane and one in space, and running it."""

import hashlib
import json
import os
import shutil
import subprocess
import sys

import trimesh

from provenance.lock import LOCK, read_lock
from provenance.plan import make_plan
from provenance.stored import read_records
from provenance.verify import verify
from tusqh.hashing import canonical_json

CONFIG = """models:
  gap:
    geometry: data_sources/gap.svg
    unit: mm
    grid: {cells: 12}
    threshold: 0.5
  ring:
    geometry: data_sources/ring.stl
    unit: mm
    grid: {cells: 8}
    target: {betti_0: 1, betti_1: 1}
snapshots: [0, 1, 2, 3, 4, 5]
sweep: [0.5, 0.2]
sweep_3d: [0.5, 1.0]
"""
REGISTER = """model,file,available,origin,url,licence,sha256,known_defects
gap,data_sources/gap.svg,yes,made for this project,,BSD-3-Clause,{gap},none
ring,data_sources/ring.stl,yes,made by this test,,CC0-1.0,{ring},two holes
"""
CHECKOUT = ["tusqh", "workflow", "profiles", "Snakefile", "CITATION.cff", "environment.yml"]
CHECKOUT += ["README.md"]


def copy_checkout(repository, folder):
    """Copy the code into a folder, with what numba and Python have compiled of it."""
    for name in CHECKOUT:
        copy = shutil.copytree if (repository / name).is_dir() else shutil.copy2
        copy(repository / name, folder / name)


def add_models(repository, folder):
    """Put a configuration and the data of two small models into a folder."""
    (folder / "config").mkdir(parents=True)
    (folder / "config/config.yaml").write_text(CONFIG)
    (folder / "data_sources").mkdir()
    gap, ring = folder / "data_sources/gap.svg", folder / "data_sources/ring.stl"
    shutil.copyfile(repository / "data_sources/analytic/gap.svg", gap)
    # So many triangles that the ingested geometry is larger than 1 MB.
    mesh = trimesh.creation.torus(10.0, 3.5, major_sections=250, minor_sections=120)
    mesh.update_faces([k not in (7, 90) for k in range(len(mesh.faces))])
    mesh.export(ring)
    digests = {p.stem: hashlib.sha256(p.read_bytes()).hexdigest() for p in (gap, ring)}
    (folder / "data_sources/register.csv").write_text(REGISTER.format(**digests))


def start(folder, *arguments, **environment):
    """Start snakemake in a folder, in a session of its own that can be killed as a whole."""
    return subprocess.Popen(
        [sys.executable, "-m", "snakemake", *arguments],
        cwd=folder,
        env={**os.environ, **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )


def snakemake(folder, *arguments, **environment):
    """Run snakemake in a folder to its end, and return what it says."""
    process = start(folder, *arguments, **environment)
    said, _ = process.communicate()
    assert process.returncode == 0, said
    return said


class Project:
    """Results with their workflow, in the present folder."""

    def __init__(self, folder, snakefile):
        self.folder = folder
        self.snakefile = snakefile

    def __truediv__(self, name):
        return self.folder / name

    def plan(self):
        return make_plan(self.snakefile)

    def verify(self):
        return verify(self.plan(), read_records(), read_lock(LOCK))

    def edit(self, name, old, new):
        """Replace a text in a file, and leave its time stamps as they were."""
        text = (self.folder / name).read_text("utf-8")
        assert old in text, f"{name} has no {old!r}"
        self.write(name, text.replace(old, new, 1).encode())

    def edit_record(self, name, change):
        """Let a function change the content of a record, and write it as a step would."""
        what = json.loads((self.folder / name).read_text())
        change(what)
        self.write(name, canonical_json(what).encode())

    def flip(self, name):
        """Flip one bit in the middle of a file, and leave its time stamps as they were."""
        content = bytearray((self.folder / name).read_bytes())
        content[len(content) // 2] ^= 1
        self.write(name, bytes(content))

    def write(self, name, content):
        path = self.folder / name
        times = path.stat()
        path.write_bytes(content)
        os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
