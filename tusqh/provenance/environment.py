"""The software a step ran with."""

from __future__ import annotations

import hashlib
import platform
import re
from importlib import metadata


def installed_versions() -> dict[str, str]:
    """Return the versions of tusqh's declared dependencies and of everything they need.

    Only packages that are installed are listed; extras of tusqh are left out.
    """
    versions: dict[str, str] = {}
    queue = ["tusqh"]
    while queue:
        name = queue.pop()
        try:
            distribution = metadata.distribution(name)
        except metadata.PackageNotFoundError:
            continue
        key = distribution.metadata["Name"].lower().replace("_", "-")
        if key in versions:
            continue
        versions[key] = distribution.version
        required = [r for r in distribution.requires or [] if "extra ==" not in r]
        queue += [re.split(r"[\s;<>=!~\[(]", r, maxsplit=1)[0] for r in required]
    return dict(sorted(versions.items()))


def environment_fingerprint(versions: dict[str, str]) -> str:
    """Return a digest of package versions, the Python minor version and the platform."""
    python = ".".join(platform.python_version_tuple()[:2])
    lines = [f"{name}=={version}" for name, version in sorted(versions.items())]
    lines += [f"python {python}", f"{platform.system()} {platform.machine()}"]
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()
