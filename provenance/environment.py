"""The software a step ran with."""

from __future__ import annotations

import hashlib
import platform
import re
from importlib import metadata

_FIELD = re.compile(r"^(Name|Version): (.*)$", re.MULTILINE)
_REQUIRED = re.compile(r"^Requires-Dist: (.*)$", re.MULTILINE)


def installed_versions() -> dict[str, str]:
    """Return the versions of tusqh's declared dependencies and of everything they need.

    Only packages that are installed are listed; extras of tusqh are left out.
    """
    versions: dict[str, str] = {}
    queue = ["tusqh"]
    while queue:
        try:
            distribution = metadata.distribution(queue.pop())
        except metadata.PackageNotFoundError:
            continue
        # Parsing whole metadata files would take longer than many a step.
        text = distribution.read_text("METADATA") or distribution.read_text("PKG-INFO") or ""
        fields = dict(_FIELD.findall(text.partition("\n\n")[0]))
        key = fields["Name"].lower().replace("_", "-")
        if key in versions:
            continue
        versions[key] = fields["Version"]
        required = [r for r in _REQUIRED.findall(text) if "extra ==" not in r]
        queue += [re.split(r"[\s;<>=!~\[(]", r, maxsplit=1)[0] for r in required]
    return dict(sorted(versions.items()))


def environment_fingerprint(versions: dict[str, str]) -> str:
    """Return a digest of package versions, the Python minor version and the platform."""
    lines = [f"{name}=={version}" for name, version in sorted(versions.items())]
    lines += [f"{name} {value}" for name, value in describe_platform().items()]
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def describe_platform() -> dict[str, str]:
    """Return the minor version of Python, the operating system and the processor family."""
    python = ".".join(platform.python_version_tuple()[:2])
    return {"python": python, "platform": f"{platform.system()} {platform.machine()}"}
