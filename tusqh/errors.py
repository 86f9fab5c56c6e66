"""Errors that state what was found, where, what was expected and what to do next."""

from __future__ import annotations

__all__ = [
    "ConfigError",
    "GeometryError",
    "MeshError",
    "OutputError",
    "ProvenanceError",
    "SamplingError",
    "SimulationError",
    "TopologyError",
    "TusqhError",
]


def one_line(text: str) -> str:
    r"""Return a text, such as the name of a file, with its control characters spelt out.

    Parameters
    ----------
    text
        The text; bytes of a name that are not UTF-8 are also spelt out.

    Examples
    --------
    >>> print(one_line("a" + chr(10) + "b.stl"))
    a\nb.stl
    """
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


class TusqhError(Exception):
    """An error that the user can fix.  All four parts of the message are required.

    Parameters
    ----------
    found
        What is wrong, in a sentence without a full stop.
    where
        The file, model, key or cell in which it was found.
    expected
        The values or the state that would have been valid.
    remedy
        What to do next.

    Examples
    --------
    >>> print(TusqhError("3 coordinates are NaN", where="bay.csv", expected="finite numbers",
    ...                  remedy="remove those rows"))
    bay.csv: 3 coordinates are NaN
      expected: finite numbers
      remedy:   remove those rows
    """

    def __init__(self, found: str, *, where: str, expected: str, remedy: str) -> None:
        super().__init__(found)
        self.found = found
        self.where = where
        self.expected = expected
        self.remedy = remedy

    def __str__(self) -> str:
        where = one_line(self.where)
        return f"{where}: {self.found}\n  expected: {self.expected}\n  remedy:   {self.remedy}"


class ConfigError(TusqhError):
    """The settings name something that does not exist, or a value is out of range."""


class OutputError(TusqhError):
    """A file or folder cannot be written."""


class GeometryError(TusqhError):
    """A geometry file is missing, unreadable, empty or not finite (dirty is not an error)."""


class SamplingError(TusqhError):
    """The grid, the window or the number of samples does not fit the geometry."""


class TopologyError(TusqhError):
    """No threshold produces the requested topology."""


class MeshError(TusqhError):
    """A mesh is not conforming, not manifold or has bad elements."""


class SimulationError(TusqhError):
    """A simulation cannot be set up, or it did not converge."""


class ProvenanceError(TusqhError):
    """Results, records and lock do not permit the requested operation."""
