"""House rules that a machine can check: layers, linters, the lock, the data register."""

import ast
import csv
import hashlib
import re
import subprocess
import sys
import tomllib
from importlib.metadata import PackageNotFoundError, metadata
from itertools import chain
from pathlib import Path

import pytest
import yaml
from docstrings import find_faults
from limits import find_beyond
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.version import Version

from tusqh.geometry.packaged import PACKAGE, locate

#: The current exceptions to the limits below; lines may only be removed.
OFFENDERS = Path(__file__).with_name("offenders.txt")


def test_imports_keep_to_the_contracts(repository):
    lint_imports = Path(sys.executable).with_name("lint-imports")
    done = subprocess.run(
        [lint_imports, "--no-cache"], cwd=repository, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr


def known_offenders():
    """Return the offenders that are still allowed."""
    lines = OFFENDERS.read_text().splitlines()
    return {line for line in lines if line and not line.startswith("#")}


def test_modules_and_functions_are_small(repository):
    beyond = [pair for pair in find_beyond(repository) if pair[0] not in known_offenders()]
    assert not beyond


def test_public_docstrings_describe_parameters_results_and_errors(repository):
    known = known_offenders()
    files = python_files(repository, "tusqh", "studies", "provenance")
    checked = [p for p in files if f"{p.relative_to(repository)}: docstrings" not in known]
    assert checked
    faults = list(chain.from_iterable(map(find_faults, checked)))
    assert not faults, "\n".join(faults)


def python_files(repository, *folders):
    """Return the Python files in some folders of the repository."""
    return sorted(path for folder in folders for path in (repository / folder).rglob("*.py"))


def compiled_functions(tree, *, cached=False):
    """Return the names of functions that numba compiles, or of those that it caches on disk."""
    wanted = "cache=True" if cached else "njit"
    return {
        node.name
        for node in tree.body
        if isinstance(node, ast.FunctionDef)
        and any(wanted in ast.unparse(decorator) for decorator in node.decorator_list)
    }


def test_no_cached_function_calls_a_compiled_one_of_another_module(repository):
    """numba's cache on disk does not notice that a callee in another file has changed."""
    files = python_files(repository, "tusqh", "studies")
    trees = {p: ast.parse(p.read_text()) for p in files}
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


def declared_requirements(repository, *, without=(), only=None):
    """Return what pyproject.toml requires: the core and most extras, or some extras only.

    Snakemake's plugin for SLURM is for the machine from which jobs are submitted.
    """
    project = tomllib.loads((repository / "pyproject.toml").read_text())["project"]
    optional = project["optional-dependencies"]
    extras = set(optional) - {"cluster", *without} if only is None else only
    lines = [*([] if only else project["dependencies"])]
    lines += chain.from_iterable(optional[e] for e in extras)
    return [r for r in map(Requirement, lines) if r.name != "tusqh"]


def test_the_lock_satisfies_the_project_file(repository):
    locked = locked_versions(repository)
    for requirement in declared_requirements(repository):
        name = requirement.name.lower().replace("_", "-")
        assert locked[name] in requirement.specifier, name


def test_the_extra_all_has_every_extra_of_the_library(repository):
    project = tomllib.loads((repository / "pyproject.toml").read_text())["project"]
    (everything,) = project["optional-dependencies"]["all"]
    others = {"all", "cluster", "test", "docs", "data", "peers"}
    assert Requirement(everything).extras == set(project["optional-dependencies"]) - others


def test_errors_name_an_extra_that_has_the_library(repository):
    project = tomllib.loads((repository / "pyproject.toml").read_text())["project"]
    distribution = {"mfem.ser": "mfem", "nrrd": "pynrrd", "shapefile": "pyshp", "igl": "libigl"}
    distribution["vtkmodules"] = "pyvista"  # It requires VTK.
    distribution |= {"yaml": "pyyaml", "PIL": "pillow", "rocrate.rocrate": "rocrate"}
    calls = []
    for path in python_files(repository, "tusqh"):
        found = re.findall(r'require\(\s*"([\w.]+)", extra="(\w+)"', path.read_text())
        calls += [pair for pair in found if path.name != "extras.py"]
    assert len(calls) > 5
    for module, extra in calls:
        top = module.partition(".")[0]
        library = distribution.get(module, distribution.get(top, top))
        listed = map(Requirement, project["optional-dependencies"][extra])
        assert library in {r.name for r in listed}, f"{module} is not in the extra {extra}"


def test_the_lock_installs_with_the_oldest_python(repository):
    project = tomllib.loads((repository / "pyproject.toml").read_text())["project"]
    oldest = project["requires-python"].removeprefix(">=") + ".0"
    optional = {r.name for r in declared_requirements(repository, only=("peers",))}
    for name in locked_versions(repository):
        try:
            required = metadata(name).get("Requires-Python")
        except PackageNotFoundError:
            assert name in optional, f"{name} is not installed"
            continue
        assert not required or oldest in SpecifierSet(required), f"{name} needs {required}"


def test_the_conda_environment_says_the_same_as_the_project_file(repository):
    project = tomllib.loads((repository / "pyproject.toml").read_text())["project"]
    declared = declared_requirements(repository, without=("docs", "data", "peers"))
    expected = {r.name.lower(): r.specifier for r in declared}
    names = {"matplotlib-base": "matplotlib", "snakemake-minimal": "snakemake"}
    listed = {}
    environment = yaml.safe_load((repository / "environment.yml").read_text())
    entries = [e for e in environment["dependencies"] if isinstance(e, str)]
    entries += next(e["pip"] for e in environment["dependencies"] if isinstance(e, dict))
    for entry in entries:
        name, specifier = re.match(r"([\w.-]+)(.*)", entry).groups()
        listed[names.get(name, name)] = SpecifierSet(specifier)
    assert listed.pop("python") == SpecifierSet(project["requires-python"])
    listed.pop("pip")
    assert listed == expected
    locked = locked_versions(repository)
    for name, specifier in listed.items():
        assert locked[name] in specifier


def test_the_register_knows_every_models_file(repository):
    config = yaml.safe_load((repository / "config/config.yaml").read_text())
    rows = {
        row["model"]: row
        for row in csv.DictReader((repository / "data_sources/register.csv").open())
    }
    for name, model in config["models"].items():
        listed = model.get("materials", [])
        sources = [] if isinstance(listed, str) else [m.get("source") for m in listed]
        assert rows[name]["file"] in [model.get("geometry"), *sources]
    for row in rows.values():
        assert row["licence"]
        if row["available"] == "yes":
            inside = row["file"].startswith(PACKAGE)
            path = locate(row["file"]) if inside else repository / row["file"]
            content = path.read_bytes()
            assert hashlib.sha256(content).hexdigest() == row["sha256"], row["model"]
        else:
            assert row["url"] or row["origin"]
