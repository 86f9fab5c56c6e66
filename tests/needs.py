"""Requirements of some tests beyond Python packages.

If a requirement is missing, its tests are skipped, and the summary states what was not run and how
to install what is missing. In continuous integration (`CI=true`) a missing tool is a failure.
"""

import importlib
import os
import shutil
from pathlib import Path

import pytest

from tusqh.quality.system_libraries import SystemLibraryError, check_rendering

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
#: The requirements of tests, and how to install them.
REMEDIES = {
    "chromium": "apt-get install chromium libatomic1 (or playwright install --with-deps chromium)",
    "pymeshlab": "apt-get install libgl1 libopengl0",
    "EGL": "apt-get install libegl1",
    "ccx": "apt-get install calculix-ccx",
}

#: Programs that are not to be had on every system; their tests are skipped in CI too.
OPTIONAL = ("ccx",)


def require(name, problem):
    """End a test whose requirement is missing; the test is skipped, or fails in CI."""
    remedy = REMEDIES.get(name, "pip install -r requirements.lock")
    message = f"needs {name}: {problem}; to get it: {remedy}"
    if name in OPTIONAL or os.environ.get("CI", "").lower() in ("", "0", "false"):
        pytest.skip(message, allow_module_level=True)
    pytest.fail(message, pytrace=False)


def import_or_require(name):
    """Import an optional package, or end the test or test module that needs it."""
    try:
        return importlib.import_module(name)
    except ImportError as error:  # A system library can also be missing.
        return require(name.partition(".")[0], str(error).splitlines()[0])


def find_browser():
    """Return the path of a Chromium on this machine: the system's, or else playwright's own."""
    for path in filter(None, map(shutil.which, BROWSERS)):
        return path
    from playwright.sync_api import sync_playwright

    try:
        with sync_playwright() as playwright:
            path = Path(playwright.chromium.executable_path)
    except Exception as error:  # Its driver also needs system libraries.
        return require("chromium", f"there is no browser, and playwright says: {error}")
    return str(path) if path.is_file() else require("chromium", "there is no browser")


def require_rendering():
    """End a test that renders pictures of solids if VTK has no library to do so."""
    try:
        check_rendering()
    except SystemLibraryError as error:
        require("EGL", str(error).splitlines()[0])
