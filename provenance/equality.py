"""How equal two results must be, and how equal they are: exact, canonical, numeric or visual."""

from __future__ import annotations

from enum import StrEnum
from fnmatch import fnmatchcase

from provenance.content import Content


class Equality(StrEnum):
    """Classes of equality, the strictest first."""

    #: The same bytes: Betti tables, thresholds, certificates.
    EXACT = "exact"
    #: The same content up to order and digits of writing: meshes, diagrams, fractions.
    CANONICAL = "canonical"
    #: Real numbers within a tolerance: fields, quality statistics.
    NUMERIC = "numeric"
    #: Drawn from equal sources: figures, and pages that show them.
    VISUAL = "visual"
    #: Never the same twice: seconds, and what fTetWild makes.  Whatever they are, they are
    #: reported so.
    MEASURED = "measured"


#: Largest difference of real numbers, relative to the largest of their column or field.
TOLERANCE = {Equality.CANONICAL: 1e-9, Equality.NUMERIC: 1e-6}

#: The class of every output, by the first pattern that fits; all others are exact.
CLASSES = [
    ("*_timing.csv", Equality.MEASURED),
    # fTetWild makes another mesh every time; its rows enter the tables of all peers.
    ("*/peers/pytetwild.csv", Equality.MEASURED),
    ("results/tables/peers*.csv", Equality.MEASURED),
    ("*.png", Equality.VISUAL),
    ("*.svg", Equality.VISUAL),
    ("*.pdf", Equality.VISUAL),
    # Pages show tables and figures.
    ("*.html", Equality.VISUAL),
    ("results/page/*", Equality.VISUAL),
    ("*/simulation/*", Equality.NUMERIC),
    ("*/elements.csv", Equality.NUMERIC),
    ("*/verdict.csv", Equality.NUMERIC),
    ("*/defects.csv", Equality.NUMERIC),
    ("*/facts.json", Equality.NUMERIC),
    ("results/tables/*", Equality.NUMERIC),
    ("*.vtu", Equality.CANONICAL),
    ("*.vtp", Equality.CANONICAL),
    ("*.npz", Equality.CANONICAL),
    ("*/diagram.csv", Equality.CANONICAL),
    ("*/export/*", Equality.CANONICAL),
    # They name digests of files that are compared themselves.
    ("*/certificate.json", Equality.CANONICAL),
    ("*/ro-crate-metadata.json", Equality.CANONICAL),
    # Comments in the copy of the workflow are free to change.
    ("results/workflow/*", Equality.CANONICAL),
]


def class_of(path: str) -> Equality:
    """Return the class that an output must reach.

    >>> class_of("results/bay/curves.csv"), class_of("results/bay/figures/diagram.png")
    (<Equality.EXACT: 'exact'>, <Equality.VISUAL: 'visual'>)
    """
    return next((kind for pattern, kind in CLASSES if fnmatchcase(path, pattern)), Equality.EXACT)


def reached(required: Equality, one: Content | None, other: Content | None) -> Equality | None:
    """Return the strictest class of two files whose bytes differ, None when they are different.

    Parameters
    ----------
    required
        The class that the file must reach; weaker ones are not tried.
    one, other
        What the two files say, None where that cannot be read.

    Notes
    -----
    Figures reach `Equality.VISUAL` through their sources, which is for the caller to see.
    """
    if one is None or other is None or required not in TOLERANCE:
        return None
    difference, _ = one.difference(other)
    tried = [kind for kind in TOLERANCE if _order(kind) <= _order(required)]
    return next((kind for kind in tried if difference <= TOLERANCE[kind]), None)


def weakest(classes: list[Equality]) -> Equality:
    """Return the weakest of some classes, exact when there are none."""
    return max(classes, key=_order, default=Equality.EXACT)


def _order(kind: Equality) -> int:
    return list(Equality).index(kind)
