"""Sample files that ship in installed packages, and the test cases."""

from importlib import metadata
from pathlib import Path

from tusqh.readers.formats import suffixes_of

PACKAGES = (
    *("matplotlib", "mfem", "mkdocs-material", "numpy", "plotly-geo", "pymeshlab", "pyvista"),
    *("scikit-image", "scipy", "sphinx", "trimesh"),
)
#: The largest number of files of a package and suffix, evenly spread over their names.
MOST = 20


def sample():
    """Return files of every supported format in the packages that are installed."""
    files = []
    for package in PACKAGES:
        try:
            listed = metadata.files(package) or []
        except metadata.PackageNotFoundError:
            continue
        for suffix in set(suffixes_of()) - {".json", ".csv"}:
            found = sorted(f for f in listed if f.suffix.lower() == suffix)
            step = -(-len(found) // MOST) or 1
            files += [Path(str(f.locate())) for f in found[::step]]
    return sorted(set(files))


def cases():
    """Return the input files of the test cases."""
    folder = Path(__file__).parent / "cases"
    return sorted(p for p in folder.glob("*/*") if p.suffix.lower() in suffixes_of())
