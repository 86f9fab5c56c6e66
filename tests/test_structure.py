"""The house rules that a machine can keep: layers, linters, the lock, the data register."""

import ast
import csv
import hashlib
import re
import subprocess
import sys
import tomllib
from importlib.metadata import metadata

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.version import Version

from tusqh.geometry.files import PACKAGE, locate

LAYERS = [
    *(
        "errors",
        "extras",
        "hashing",
        "atomic",
        "progress",
        "tables",
        "grid",
        "geometry",
        "sampling",
        "topology",
    ),
    *("meshes", "antialias", "threshold", "simulate", "quality", "figures"),
    *("certificate", "pipeline", "explorer", "overview", "config"),
    *("add_model", "cli", "__main__"),
]


def test_modules_import_only_from_layers_above(repository):
    for path in sorted((repository / "tusqh").rglob("*.py")):
        parts = path.relative_to(repository / "tusqh").with_suffix("").parts
        if parts == ("__init__",):
            continue
        own = LAYERS.index(parts[0])
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("tusqh."):
                layer = node.module.split(".")[1]
                assert LAYERS.index(layer) <= own, f"{path.name} imports {node.module}"


def compiled_functions(tree, *, cached=False):
    """Names of functions that numba compiles, or of those whose code it keeps on disk."""
    wanted = "cache=True" if cached else "njit"
    return {
        node.name
        for node in tree.body
        if isinstance(node, ast.FunctionDef)
        and any(wanted in ast.unparse(decorator) for decorator in node.decorator_list)
    }


def test_no_cached_function_calls_a_compiled_one_of_another_module(repository):
    """numba's cache on disk does not notice that a callee in another file has changed."""
    trees = {p: ast.parse(p.read_text()) for p in (repository / "tusqh").rglob("*.py")}
    compiled = set().union(*map(compiled_functions, trees.values()))
    for path, tree in trees.items():
        own, cached = compiled_functions(tree), compiled_functions(tree, cached=True)
        for node in tree.body:
            if isinstance(node, ast.FunctionDef) and node.name in cached:
                called = {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}
                foreign = called & (compiled - own)
                assert not foreign, f"{path.name}: {node.name} calls {foreign}"


@pytest.mark.parametrize(
    "command",
    [
        ["ruff", "check", "."],
        ["ruff", "format", "--check", "."],
        ["mypy", "--strict"],
        ["snakemake", "--lint"],
    ],
    ids=" ".join,
)
def test_linters_are_content(repository, command):
    done = subprocess.run(
        [sys.executable, "-m", *command], cwd=repository, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr


def locked_versions(repository):
    lines = (repository / "requirements.lock").read_text().splitlines()
    pairs = [line.split("==") for line in lines if "==" in line]
    return {name.lower().replace("_", "-"): Version(version) for name, version in pairs}


def test_the_lock_satisfies_the_project_file(repository):
    project = tomllib.loads((repository / "pyproject.toml").read_text())["project"]
    locked = locked_versions(repository)
    declared = [*project["dependencies"], *project["optional-dependencies"]["test"]]
    for requirement in map(Requirement, declared):
        name = requirement.name.lower().replace("_", "-")
        assert locked[name] in requirement.specifier, name


def test_the_lock_installs_with_the_oldest_python(repository):
    project = tomllib.loads((repository / "pyproject.toml").read_text())["project"]
    oldest = project["requires-python"].removeprefix(">=") + ".0"
    for name in locked_versions(repository):
        required = metadata(name).get("Requires-Python")
        assert not required or oldest in SpecifierSet(required), f"{name} needs {required}"


def test_the_conda_environment_says_the_same_as_the_project_file(repository):
    project = tomllib.loads((repository / "pyproject.toml").read_text())["project"]
    declared = [*project["dependencies"], *project["optional-dependencies"]["test"]]
    expected = {Requirement(d).name.lower(): str(Requirement(d).specifier) for d in declared}
    names = {"matplotlib-base": "matplotlib", "snakemake-minimal": "snakemake"}
    listed = {}
    environment = yaml.safe_load((repository / "environment.yml").read_text())
    entries = [e for e in environment["dependencies"] if isinstance(e, str)]
    entries += next(e["pip"] for e in environment["dependencies"] if isinstance(e, dict))
    for entry in entries:
        name, specifier = re.match(r"([\w.-]+)(.*)", entry).groups()
        listed[names.get(name, name)] = specifier
    assert listed.pop("python") == project["requires-python"]
    listed.pop("pip")
    assert listed == expected
    locked = locked_versions(repository)
    for name, specifier in listed.items():
        assert locked[name] in Requirement(name + specifier).specifier


def test_the_register_knows_every_models_file(repository):
    config = yaml.safe_load((repository / "config/config.yaml").read_text())
    rows = {
        row["model"]: row
        for row in csv.DictReader((repository / "data_sources/register.csv").open())
    }
    for name, model in config["models"].items():
        assert rows[name]["file"] == model["geometry"]
    for row in rows.values():
        assert row["licence"]
        if row["available"] == "yes":
            inside = row["file"].startswith(PACKAGE)
            path = locate(row["file"]) if inside else repository / row["file"]
            content = path.read_bytes()
            assert hashlib.sha256(content).hexdigest() == row["sha256"], row["model"]
        else:
            assert row["url"] or row["origin"]
