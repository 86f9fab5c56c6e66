"""Describe the installed packages, Python and the platform of a step."""

from __future__ import annotations

import hashlib
import platform
import re
from importlib import metadata

#: The extras of tusqh whose packages can affect results.
EXTRAS = ("cli", "figures", "formats", "simulate", "verdict", "workflow")

_FIELD = re.compile(r"^(Name|Version): (.*)$", re.MULTILINE)
_REQUIRED = re.compile(r"^Requires-Dist: (.*)$", re.MULTILINE)
_EXTRA = re.compile(r"extra == [\"']([\w-]+)[\"']")


def installed_versions() -> dict[str, str]:
    """Return the versions of tusqh, its dependencies with `EXTRAS`, and all their requirements.

    Packages that are not installed, and optional dependencies of other packages, are omitted.
    """
    versions: dict[str, str] = {}
    queue = ["tusqh"]
    while queue:
        name = queue.pop()
        try:
            distribution = metadata.distribution(name)
        except metadata.PackageNotFoundError:
            continue
        # Parsing whole metadata files would take longer than many steps.
        text = distribution.read_text("METADATA") or distribution.read_text("PKG-INFO") or ""
        fields = dict(_FIELD.findall(text.partition("\n\n")[0]))
        key = fields["Name"].lower().replace("_", "-")
        if key not in versions:
            versions[key] = fields["Version"]
            extras = EXTRAS if name == "tusqh" else ()
            queue += _required_names(_REQUIRED.findall(text), extras)
    return dict(sorted(versions.items()))


def _required_names(requirements: list[str], extras: tuple[str, ...]) -> list[str]:
    """Return the names of required packages, without those of other extras.

    >>> _required_names(["numpy>=2.0", 'mfem>=4.7; extra == "simulate"'], ())
    ['numpy']
    """
    return [
        re.split(r"[\s;<>=!~\[(]", requirement, maxsplit=1)[0]
        for requirement in requirements
        if (extra := _EXTRA.search(requirement)) is None or extra[1] in extras
    ]


def environment_fingerprint(versions: dict[str, str]) -> str:
    """Return a digest of package versions, the Python minor version and the platform.

    Parameters
    ----------
    versions
        The version of each package, by name.
    """
    lines = [f"{name}=={version}" for name, version in sorted(versions.items())]
    lines += [f"{name} {value}" for name, value in describe_platform().items()]
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def describe_platform() -> dict[str, str]:
    """Return the minor version of Python, the operating system and the processor family."""
    python = ".".join(platform.python_version_tuple()[:2])
    return {"python": python, "platform": f"{platform.system()} {platform.machine()}"}


def changed_versions(was: dict[str, str], now: dict[str, str]) -> list[tuple[str, str]]:
    """Return the packages whose versions differ, before and after, as ``numpy 2.4.6``.

    Parameters
    ----------
    was
        The versions before, by package.
    now
        The versions now, by package.

    Examples
    --------
    >>> changed_versions({"numpy": "2.0", "vtk": "9"}, {"numpy": "2.1", "vtk": "9"})
    [('numpy 2.0', 'numpy 2.1')]
    """
    names = sorted(name for name in was.keys() | now.keys() if was.get(name) != now.get(name))
    return [
        (f"{name} {was.get(name, 'absent')}", f"{name} {now.get(name, 'absent')}") for name in names
    ]
