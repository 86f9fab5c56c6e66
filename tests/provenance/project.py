"""Results and the workflow that made them, for tests that change them."""

import json
import os

from provenance.lock import LOCK, read_lock
from provenance.plan import make_plan
from provenance.stored import read_records
from provenance.verify import verify
from tusqh.hashing import canonical_json


class Project:
    """Results with their workflow, in the current folder."""

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
        """Flip one bit in the middle of a file without changing its time stamps."""
        content = bytearray((self.folder / name).read_bytes())
        content[len(content) // 2] ^= 1
        self.write(name, bytes(content))

    def write(self, name, content):
        path = self.folder / name
        times = path.stat()
        path.write_bytes(content)
        os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
