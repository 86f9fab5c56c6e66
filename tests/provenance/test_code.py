"""Fingerprints of code change with the code that a step reaches, and with no other."""

import subprocess
import sys

import pytest

from provenance import code
from provenance.code import code_files, code_fingerprint, code_fingerprints

SCRIPT = "scripts/step.py"
FILES = {
    SCRIPT: "from tusqh.deep import first\nimport beside\n",
    "scripts/beside.py": "X = 1\n",
    "tusqh/__init__.py": (
        '__version__ = "1"\ndef __getattr__(name):\n    from tusqh.heavy import mesh\n'
        "    return mesh\n"
    ),
    "tusqh/heavy.py": "mesh = 1\n",
    "tusqh/deep/__init__.py": "",
    "tusqh/deep/first.py": (
        "from typing import TYPE_CHECKING\nfrom . import second\nfrom ..lazy import later\n"
        "if TYPE_CHECKING:\n    from tusqh import typing_only\n"
        "SCHEMA = 'schema.json'\n"
    ),
    "tusqh/deep/schema.json": "{}",
    "tusqh/deep/second.py": "def f():\n    import tusqh.third\n",
    "tusqh/third.py": "import numpy\nCONSTANT = 0.5\n",
    "tusqh/lazy.py": "NAMES = {'x': 'tusqh.named'}\nlater = 1\n",
    "tusqh/named.py": "",
    "tusqh/typing_only.py": "",
    "tusqh/unrelated.py": "from tusqh import third\n",
}


@pytest.fixture
def project(tmp_path, monkeypatch):
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(code, "PACKAGE_ROOT", tmp_path)
    return tmp_path


def test_the_closure_of_imports(project):
    expected = FILES.keys() - {"tusqh/heavy.py", "tusqh/typing_only.py", "tusqh/unrelated.py"}
    assert code_files(SCRIPT, base=project).keys() == expected


def test_a_name_made_on_demand_brings_what_it_needs(project):
    (project / SCRIPT).write_text("from tusqh import mesh\n")
    assert "tusqh/heavy.py" in code_files(SCRIPT, base=project)
    (project / SCRIPT).write_text("from tusqh import __version__\n")
    assert code_files(SCRIPT, base=project).keys() == {SCRIPT, "tusqh/__init__.py"}


@pytest.mark.parametrize(
    ("file", "text", "moves"),
    [
        ("tusqh/third.py", "import numpy\nCONSTANT = 0.25\n", True),
        ("tusqh/third.py", "import numpy\nCONSTANT = 5e-1\n", False),
        ("tusqh/third.py", '"""Doc."""\nimport numpy  # x\n\n\nCONSTANT = (0.5)\n', False),
        ("tusqh/deep/second.py", 'def f():\n    "doc"\n    import tusqh.third\n', False),
        ("tusqh/deep/schema.json", '{"a": 1}', True),
        ("scripts/beside.py", "X = True\n", True),
        ("tusqh/unrelated.py", "X = 1\n", False),
        ("tusqh/heavy.py", "X = 1\n", False),
    ],
)
def test_what_moves_the_fingerprint(project, file, text, moves):
    scripts, store = [SCRIPT, "tusqh/lazy.py"], project / "provenance/__pycache__/store.json"
    store.parent.parent.mkdir()
    before = code_fingerprint(SCRIPT, base=project)
    assert code_fingerprints(scripts, base=project, store=store)[SCRIPT] == before
    (project / file).write_text(text)
    after = code_fingerprint(SCRIPT, base=project)
    assert (after != before) == moves
    # Those kept in a file follow the code too, also that of modules next to scripts.
    kept = code_fingerprints(scripts, base=project, store=store)
    assert kept == {SCRIPT: after, scripts[1]: code_fingerprint(scripts[1], base=project)}


def test_fingerprints_of_unchanged_code_are_read(project, monkeypatch):
    store = project / "provenance/__pycache__/store.json"
    store.parent.parent.mkdir()
    first = code_fingerprints([SCRIPT], base=project, store=store)
    monkeypatch.setattr(code, "code_files", lambda *_, **__: pytest.fail("computed again"))
    assert code_fingerprints([SCRIPT], base=project, store=store) == first


def test_every_module_that_a_script_really_imports_is_in_its_closure(repository):
    """As a second method, ask Python which modules of the package are loaded."""
    program = """
import ast, importlib, sys
from pathlib import Path
for node in ast.parse(Path(sys.argv[1]).read_text()).body:
    if isinstance(node, ast.ImportFrom) and node.module.startswith("tusqh"):
        importlib.import_module(node.module)
print(*[m.__file__ for n, m in sys.modules.items() if n.split(".")[0] == "tusqh" and m.__file__])
"""
    for script in ("mesh", "figures_of_solid", "explorer"):
        name = f"workflow/scripts/{script}.py"
        command = [sys.executable, "-c", program, str(repository / name)]
        loaded = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
        labels = {path[len(str(repository)) + 1 :] for path in loaded}
        assert len(labels) > 10
        assert labels <= code_files(name, base=repository).keys()
