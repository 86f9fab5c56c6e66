"""Describe a reading: counts, bounding box, unit, whether the geometry is closed, and remarks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import pandas as pd

from tusqh.geometry.defect import Defect, tabulate_defects
from tusqh.geometry.image import Image
from tusqh.geometry.kinds import kind_of
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup_defects import SOUP_DEFECTS
from tusqh.geometry.soup_facts import SoupFacts
from tusqh.readers.reading import Reading

#: Counts of what was read, by kind of geometry, and the count that is 0 if the geometry is closed.
_COUNTS = {
    "surface": (("parts", "triangles", "points"), "boundary_edges"),
    "outline": (("chains", "segments", "points"), "open_ends"),
    "image": (("voxels_x", "voxels_y", "voxels_z"), ""),
    "picture": (("pixels_x", "pixels_y"), ""),
}
_SOURCES = {"file": "stated by the file", "format": "fixed by the format", "settings": "as given"}


def describe_reading(reading: Reading) -> dict[str, Any]:
    """Return a description of a reading as plain values.

    Parameters
    ----------
    reading
        The geometry and the reader's remarks.

    Returns
    -------
    dict
        ``name``, ``format``, ``kind``; ``counts`` of parts (chains), faces (segments) and points,
        or of voxels along each axis; ``box``, the lowest and the highest corner; ``unit`` with its
        ``name`` (None if there is none) and ``source`` (file, format, settings or none);
        ``closed`` (None for images and pictures); and ``remarks``, each with effect, what, count
        and remedy.

    Examples
    --------
    >>> import numpy as np
    >>> corner = Outline.from_chains([np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 2.0]])])
    >>> facts = describe_reading(Reading(corner))
    >>> facts["counts"], facts["closed"]
    ({'segments': 2, 'chains': 1, 'open_ends': 2, 'points': 3}, False)
    """
    geometry = reading.geometry
    kind = kind_of(geometry)
    if isinstance(geometry, Image):
        counts = dict(zip(_COUNTS[kind][0], geometry.shape, strict=True))
    elif isinstance(geometry, Outline):
        from tusqh.geometry.outline_defects import OUTLINE_DEFECTS
        from tusqh.geometry.outline_facts import OutlineFacts

        of_outline = OutlineFacts(geometry)
        table = tabulate_defects(_chosen(OUTLINE_DEFECTS), of_outline)
        counts = _with_points(table, len(of_outline.points))
    else:
        of_soup = SoupFacts(geometry)
        table = tabulate_defects(_chosen(SOUP_DEFECTS), of_soup)
        counts = _with_points(table, len(of_soup.points))
    return {
        "name": geometry.name,
        "format": reading.format,
        "kind": kind,
        "counts": counts,
        "box": [list(corner) for corner in geometry.bounding_box()],
        "unit": {"name": reading.unit or None, "source": reading.unit_source},
        "closed": None if isinstance(geometry, Image) else not counts[_COUNTS[kind][1]],
        "remarks": [asdict(remark) for remark in reading.remarks],
    }


def lines_of_reading(facts: Mapping[str, Any]) -> dict[str, str]:
    """Return a description of a reading in three lines, each with its title.

    Parameters
    ----------
    facts
        The facts from `describe_reading`.

    Examples
    --------
    >>> import numpy as np
    >>> corner = Outline.from_chains([np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 2.0]])])
    >>> for title, text in lines_of_reading(describe_reading(Reading(corner))).items():
    ...     print(f"{title}: {text}")
    read: memory: 1 chain, 2 segments, 3 points, open (2 open ends)
    box: (0, 0) to (1, 2)
    unit: not stated
    """
    counts, (nouns, fault) = facts["counts"], _COUNTS[facts["kind"]]
    if not fault:
        text = " x ".join(f"{n:,}" for n in counts.values())
        text += f" {nouns[0].partition('_')[0]}"
    else:
        is_open = f"open ({_in_words(counts[fault], fault)})"
        texts = [_in_words(counts[noun], noun) for noun in nouns]
        text = ", ".join([*texts, "closed" if facts["closed"] else is_open])
    low, high = (", ".join(f"{x:.6g}" for x in corner) for corner in facts["box"])
    unit = facts["unit"]
    source = _SOURCES.get(unit["source"])
    return {
        "read": f"{facts['format']}: {text}",
        "box": f"({low}) to ({high})",
        "unit": f"{unit['name']}, {source}" if source else "not stated",
    }


def _chosen(defects: Sequence[Defect[Any]]) -> list[Defect[Any]]:
    """Return the rows of the table of defects that are also counts of a reading."""
    wanted = {noun for nouns, fault in _COUNTS.values() for noun in (*nouns, fault)}
    return [defect for defect in defects if defect.name in wanted]


def _with_points(table: pd.DataFrame, n_points: int) -> dict[str, int]:
    """Return the counts of a table of defects, and the number of points."""
    return {**dict(zip(table["defect"], table["count"].tolist(), strict=True)), "points": n_points}


def _in_words(n: int, noun: str) -> str:
    """Return a count with its noun; `noun` is a plural."""
    words = noun.replace("_", " ")
    return f"{n:,} {words[:-1] if n == 1 else words}"
