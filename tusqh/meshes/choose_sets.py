"""Name sets by a place, and write the table of all sets."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from tusqh.errors import ConfigError
from tusqh.grid import FloatArray
from tusqh.meshes.interfaces import facet_areas
from tusqh.meshes.sets import FacetSet, NamedSets
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.tables import write_csv

#: Kinds of sets of facets that a wish may name.
KINDS_OF_FACETS = ("hole", "void", "recess", "wall", "plane", "patch", "input", "boundary")

#: Columns of the table of sets.
COLUMNS = (
    *("name", "kind", "number", "facets", "elements", "points", "area", "volume"),
    *("x", "y", "z", "meaning"),
)


@dataclass(frozen=True)
class Wish:
    """A name for the set that is nearest to a place.

    Parameters
    ----------
    name
        The name, of letters, digits and underscores.
    kind
        The kind of set; ``"near"``: a hole, or any set if the mesh has no holes.
    place
        The place, in model units.
    """

    name: str
    kind: str
    place: tuple[float, ...]

    @classmethod
    def read(cls, text: str) -> Wish:
        """Return the wish that the option ``--set`` describes.

        Parameters
        ----------
        text
            ``NAME=near:X,Y,Z``, or a kind of `KINDS_OF_FACETS` in place of ``near``.

        Raises
        ------
        ConfigError
            The text has another form.

        Examples
        --------
        >>> Wish.read("bolt=near:30,20,0")
        Wish(name='bolt', kind='near', place=(30.0, 20.0, 0.0))
        """
        form = re.fullmatch(r"(\w+)=(\w+):([^,]+(?:,[^,]+){1,2})", text.strip(), re.ASCII)
        try:
            if form is None or form[2] not in ("near", *KINDS_OF_FACETS):
                raise ValueError
            place = tuple(float(number) for number in form[3].split(","))
            if not np.isfinite(place).all():
                raise ValueError
        except ValueError:
            raise ConfigError(
                f"found {text!r}",
                where="option --set",
                expected="NAME=near:X,Y,Z, or in place of near one of "
                + ", ".join(KINDS_OF_FACETS),
                remedy="give for instance --set bolt=near:30,20,0",
            ) from None
        assert form is not None
        return cls(form[1], form[2], place)


def name_sets(mesh: VolumeMesh, sets: NamedSets, wishes: Sequence[Wish]) -> NamedSets:
    """Return the sets with the names that were wished for.

    The nearest set is the one to whose box the place is nearest, and of several the one whose
    centre is nearest.

    Parameters
    ----------
    mesh
        The mesh.
    sets
        Its sets.
    wishes
        Names for some of its sets of facets.

    Raises
    ------
    ConfigError
        A name is taken, two names are given to one set, no set is of that kind, or a place has the
        wrong number of coordinates.
    """
    facets = list(sets.facets)
    owner: dict[int, str] = {}
    for wish in wishes:
        number = _nearest(mesh, facets, wish).number
        taken = {f.name for f in facets} | {e.name for e in [*sets.blocks, *sets.groups]}
        if number in owner or wish.name in taken:
            other = owner.get(number)
            raise ConfigError(
                f"{wish.name} and {other} name the same set"
                if other
                else f"a set is called {wish.name} already",
                where="option --set",
                expected="one name for each set, and another one for other sets",
                remedy="change the name or the place; NAME_sets.csv lists the sets",
            )
        owner[number] = wish.name
        facets = [f._replace(name=wish.name) if f.number == number else f for f in facets]
    return replace(sets, facets=facets)


def _nearest(mesh: VolumeMesh, facets: Sequence[FacetSet], wish: Wish) -> FacetSet:
    """Return the set of facets that is nearest to the place of a wish."""
    if len(wish.place) != mesh.dim:
        raise ConfigError(
            f"the place of {wish.name} has {len(wish.place)} coordinates",
            where="option --set",
            expected=f"{mesh.dim}",
            remedy="give as many as the mesh has dimensions",
        )
    kinds: tuple[str, ...] = (wish.kind,)
    if wish.kind == "near":
        has_holes = any(found.kind == "hole" for found in facets)
        kinds = ("hole",) if has_holes else ("void", "recess", "wall", "plane")
    among = [found for found in facets if found.kind in kinds]
    if not among:
        raise ConfigError(
            f"the mesh has no set of the kind {wish.kind}",
            where="option --set",
            expected="one of " + ", ".join(sorted({found.kind for found in facets})),
            remedy="ask for another kind; NAME_sets.csv lists the sets",
        )
    place = np.array(wish.place)

    def away(found: FacetSet) -> tuple[float, float]:
        points = mesh.points[np.unique(found.corners)]
        low, high = points.min(axis=0), points.max(axis=0)
        to_box = float(np.linalg.norm(np.maximum(np.maximum(low - place, place - high), 0)))
        return to_box, float(np.linalg.norm(_centre(mesh, found) - place))

    return min(among, key=away)


def _centre(mesh: VolumeMesh, found: FacetSet) -> FloatArray:
    """Return the centre of the facets of a set, weighted by area."""
    areas = facet_areas(mesh.points, found.corners)
    middle = mesh.points[found.corners].mean(axis=1)
    return np.asarray((areas[:, None] * middle).sum(axis=0) / max(float(areas.sum()), 1e-300))


def table_of_sets(mesh: VolumeMesh, sets: NamedSets) -> pd.DataFrame:
    """Return the table of all sets, with the columns `COLUMNS`.

    Parameters
    ----------
    mesh
        The mesh.
    sets
        Its sets.
    """
    rows: list[dict[str, object]] = []
    for found in sets.facets:
        row = {"name": found.name, "kind": found.kind, "number": found.number}
        area = float(facet_areas(mesh.points, found.corners).sum())
        size = {"facets": len(found.element), "area": area}
        size["points"] = len(np.unique(found.corners))
        rows.append({**row, **size, **_place(_centre(mesh, found)), "meaning": found.meaning})
    for block in [*sets.blocks, *sets.groups]:
        cells = mesh.cells[block.elements]
        row = {"name": block.name, "kind": block.kind, "number": block.number}
        volumes = mesh.volumes[block.elements]
        total = float(volumes.sum())
        centre = (volumes[:, None] * mesh.points[cells].mean(axis=1)).sum(axis=0)
        size = {"elements": len(cells), "volume": total, "points": len(np.unique(cells))}
        rows.append({**row, **size, **_place(centre / total), "meaning": block.meaning})
    for points in sets.points:
        row = {"name": points.name, "kind": "junction", "number": points.number}
        centre = mesh.points[points.points].mean(axis=0)
        meaning = "points at which these three meet"
        rows.append({**row, "points": len(points.points), **_place(centre), "meaning": meaning})
    table = pd.DataFrame(rows, columns=list(COLUMNS))
    return table.astype(dict.fromkeys(("facets", "elements", "points"), "Int64"))


def _place(centre: FloatArray) -> dict[str, float]:
    return dict(zip("xyz", centre.tolist(), strict=False))


def write_table_of_sets(path: Path, mesh: VolumeMesh, sets: NamedSets) -> None:
    """Write the table of all sets as CSV.

    Parameters
    ----------
    path
        File to write.
    mesh, sets
        See `table_of_sets`.
    """
    table = table_of_sets(mesh, sets)
    write_csv(path, table if mesh.dim == 3 else table.drop(columns="z"))
