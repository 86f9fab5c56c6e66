"""Compute a fingerprint of the code of a step: its script and the project modules it imports.

Snakemake does not notice an edit inside an imported package.  The fingerprint is a parameter of
each rule, so changing a constant three imports deep reruns the steps that reach it, whereas a
comment, a docstring or a new layout reruns none.

This module follows the imports itself instead of using a library such as grimp, whose graph has one
node per module: it does not distinguish imports that a package runs on import from those inside a
function, and omits data files next to modules and modules next to a script.  With grimp, a change
would rerun steps that do not depend on it.
"""

from __future__ import annotations

import ast
import json
import os
import re
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

from tusqh.atomic import remove_leftovers, write_text
from tusqh.hashing import canonical_json, hash_file, hash_value

#: The folder of the packages of the project.
PACKAGE_ROOT = Path(__file__).resolve().parents[1]
#: The packages of the project.
PACKAGES = ("tusqh", "studies", "provenance")

#: Strings that can name a file or folder next to a module.
_FILE_NAME = re.compile(r"\w[\w.-]*(/[\w.-]+)*")
#: Fields that have no meaning at run time; `ctx` follows from the position.
_IGNORED_FIELDS = {"ctx", "kind", "type_comment", "type_ignores"}


def code_fingerprint(script: str, *, base: Path) -> dict[str, str]:
    """Return the script and the SHA-256 of the list that `code_files` returns.

    Parameters
    ----------
    script
        The script of a rule, as a path in the checkout.
    base
        The checkout.
    """
    return {"script": script, "sha256": hash_value(code_files(script, base=base))}


def code_fingerprints(
    scripts: Iterable[str], *, base: Path, store: Path
) -> dict[str, dict[str, str]]:
    """Return the fingerprints of scripts by script, from a file where no file of code has changed.

    Parameters
    ----------
    scripts
        Scripts and modules, as paths in the checkout.
    base
        The checkout.
    store
        File that keeps the fingerprints, with a digest of all files of code; it is not written
        in a checkout that cannot be written to.
    """
    scripts = sorted(set(scripts))
    state = hash_value([_contents(base, scripts), Path(__file__).read_text("utf-8")])
    kept = json.loads(store.read_text("utf-8")) if store.is_file() else {}
    found = kept.get("fingerprints", {}) if kept.get("state") == state else {}
    if not found.keys() >= set(scripts):
        found = {script: code_fingerprint(script, base=base) for script in scripts}
        if os.access(store.parent.parent, os.W_OK):
            store.parent.mkdir(exist_ok=True)
            write_text(store, canonical_json({"state": state, "fingerprints": found}))
    return {script: found[script] for script in scripts}


def _contents(base: Path, scripts: Iterable[str]) -> dict[str, str]:
    """Return the SHA-256 of all files of the packages and next to scripts, by path."""
    folders = [PACKAGE_ROOT / name for name in PACKAGES]
    folders += sorted({(base / script).parent for script in scripts})
    paths = {path for folder in folders for path in folder.rglob("*") if path.is_file()}
    kept = sorted(path for path in paths if "__pycache__" not in path.parts)
    return {path.as_posix(): hash_file(path) for path in kept}


def workflow_digest(files: Iterable[Path]) -> str:
    """Return a SHA-256 of scripts and rules without comments and blank lines.

    Parameters
    ----------
    files
        Python scripts, whose docstrings and layout are also ignored, and files in the language of
        Snakemake.
    """
    return hash_value([_workflow_file_digest(path) for path in files])


def _workflow_file_digest(path: Path) -> str:
    if path.suffix == ".py":
        return _digest(ast.parse(path.read_bytes()))
    lines = map(str.rstrip, path.read_text("utf-8").splitlines())
    return hash_value([line for line in lines if line and not line.lstrip().startswith("#")])


def list_code(script: str, *, base: Path, folder: Path) -> None:
    """Write the list of files behind a fingerprint to ``<folder>/<fingerprint>.json``.

    Records only contain the fingerprint.  The workflow writes these lists when it starts, so that
    `tusqh verify` can name the file that changed.

    Parameters
    ----------
    script
        The script or module, relative to `base`.
    base
        Root of the repository.
    folder
        Folder to write to.
    """
    path = folder / f"{code_fingerprint(script, base=base)['sha256']}.json"
    remove_leftovers(path)
    if not path.exists():
        write_text(path, canonical_json(code_files(script, base=base)))


def code_files(script: str, *, base: Path) -> dict[str, str]:
    """Return the files of this project on which a script depends, each with a digest.

    All imports of a module count, including those inside functions.  For a package that contains an
    imported module, only the imports that its ``__init__`` runs on import count.  A string that
    names a file next to its module (a schema, a template) is a dependency on that file.

    Parameters
    ----------
    script
        The script of a rule, such as ``workflow/scripts/mesh.py``; modules next to it also belong
        to the project.
    base
        The checkout.

    Returns
    -------
    dict
        The SHA-256 by path, such as ``tusqh/grid.py``.  For Python it is computed from the syntax
        tree without docstrings and positions, for other files from the bytes.
    """
    base = base.resolve()
    own = base / script
    seen: set[tuple[Path, bool]] = set()
    queue = [(own, True)]
    while queue:
        module = queue.pop()
        if module not in seen and (module[0], True) not in seen:
            seen.add(module)
            queue += _read(*_version(module[0])).dependencies(own.parent, module[1])
    return {
        _label(path, base): _read(*_version(path)).digest for path in sorted({p for p, _ in seen})
    }


def _label(path: Path, base: Path) -> str:
    is_ours = any(path.is_relative_to(PACKAGE_ROOT / name) for name in PACKAGES)
    return path.relative_to(PACKAGE_ROOT if is_ours else base).as_posix()


class _Source:
    """One file of the project, with its digest and dependencies."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.tree = ast.parse(path.read_bytes()) if path.suffix == ".py" else None
        self.digest = hash_file(path) if self.tree is None else _digest(self.tree)
        self.known: dict[tuple[Path, bool], list[tuple[Path, bool]]] = {}

    def dependencies(self, scripts: Path, whole: bool) -> list[tuple[Path, bool]]:
        """Return the dependencies, and whether all their imports count or only those on import."""
        if (scripts, whole) not in self.known:
            self.known[scripts, whole] = self._find(scripts, whole)
        return self.known[scripts, whole]

    def _find(self, scripts: Path, whole: bool) -> list[tuple[Path, bool]]:
        if self.tree is None:
            return []
        found: list[tuple[Path, bool]] = []
        for node in _nodes(self.tree, into_functions=whole):
            if isinstance(node, ast.Import):
                for alias in node.names:
                    found += _module(alias.name, scripts)
            elif isinstance(node, ast.ImportFrom):
                for alias in node.names:
                    found += self._imported(node, alias.name, scripts)
            elif whole and isinstance(node, ast.Constant) and isinstance(node.value, str):
                found += self._named(node.value, scripts)
        return found

    def _imported(self, node: ast.ImportFrom, name: str, scripts: Path) -> list[tuple[Path, bool]]:
        module = node.module or ""
        if node.level:
            folder = self.path.parents[node.level - 1].relative_to(PACKAGE_ROOT)
            module = ".".join([*folder.parts, *filter(None, [module])])
        if inner := _module(f"{module}.{name}", scripts):
            return inner
        found = _module(module, scripts)
        if found and found[-1][0].name == "__init__.py":
            path = found[-1][0]
            is_lazy = name not in _read(*_version(path)).names_on_import()
            found[-1] = (path, is_lazy)
        return found

    def _named(self, text: str, scripts: Path) -> list[tuple[Path, bool]]:
        """Return the files that a string names: a module to import later, a file or a folder."""
        if text.startswith(tuple(f"{name}." for name in PACKAGES)) and (
            found := _module(text, scripts)
        ):
            return found
        if len(text) > 100 or not _FILE_NAME.fullmatch(text):
            return []
        path = self.path.parent / text
        if path.is_dir() and not (path / "__init__.py").exists() and path.name != "__pycache__":
            return [(p, True) for p in sorted(path.rglob("*")) if p.is_file()]
        return [(path, True)] if path.suffix != ".py" and path.is_file() else []

    def names_on_import(self) -> set[str]:
        """Return the names that the module defines on import, without its `__getattr__`."""
        assert self.tree is not None
        names: set[str] = set()
        for node in _nodes(self.tree, into_functions=False):
            if isinstance(node, ast.Name):
                names.add(node.id)
            elif isinstance(node, ast.FunctionDef | ast.ClassDef):
                names.add(node.name)
            elif isinstance(node, ast.Import | ast.ImportFrom):
                names |= {alias.asname or alias.name for alias in node.names}
        return names


def _version(path: Path) -> tuple[Path, int, int]:
    """Return a path with its size and modification time, so that `_read` rereads an edited file."""
    state = path.stat()
    return path, state.st_size, state.st_mtime_ns


@cache
def _read(path: Path, size: int, modified: int) -> _Source:
    return _Source(path)


def _module(name: str, scripts: Path) -> list[tuple[Path, bool]]:
    """Return the files that run when a module of the project is imported; its own file is last."""
    parts = name.split(".")
    root = PACKAGE_ROOT if parts[0] in PACKAGES else scripts
    *parents, own = [root.joinpath(*parts[:k]) for k in range(1, len(parts) + 1)]
    for path in (own.with_name(own.name + ".py"), own / "__init__.py"):
        if path.is_file():
            above = [(parent / "__init__.py", False) for parent in parents]
            return [*(p for p in above if p[0].is_file()), (path, True)]
    return []


def _nodes(tree: ast.AST, *, into_functions: bool) -> Iterator[ast.AST]:
    """Walk a syntax tree, skipping docstrings and blocks for type checkers."""
    left = list(ast.iter_child_nodes(tree))
    while left:
        node = left.pop()
        if _is_docstring(node):
            continue
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            continue
        yield node
        if into_functions or not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            left += ast.iter_child_nodes(node)


def _is_docstring(node: object) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def _digest(tree: ast.AST) -> str:
    return hash_value(_to_text(tree))


def _to_text(node: object) -> str:
    """Return a syntax tree as text that is independent of the Python version.

    `ast.dump` lists fields that are empty in one version and absent in another.
    """
    if isinstance(node, ast.Constant):
        return f"{type(node.value).__name__}:{node.value!r}"
    if isinstance(node, ast.AST):
        fields = [
            f"{name}={_to_text(value)}"
            for name, value in ast.iter_fields(node)
            if name not in _IGNORED_FIELDS and value is not None and value != []
        ]
        return f"{type(node).__name__}({','.join(fields)})"
    if isinstance(node, list):
        return "[" + ",".join(_to_text(item) for item in node if not _is_docstring(item)) + "]"
    return repr(node)
