"""Common backgrounds: boxes, boxes whose layers grow from one side, and cylinders."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tusqh.background.background_mesh import BackgroundMesh
from tusqh.errors import ConfigError
from tusqh.grid import FloatArray, IntArray

#: Half the side of the square core of a cylinder, as a share of the radius.
_CORE = 0.42


def make_box(
    lower: Sequence[float], upper: Sequence[float], cells: Sequence[int], *, unit: str = ""
) -> BackgroundMesh:
    """Return a box of equal cells.

    Parameters
    ----------
    lower, upper
        Its corners, two or three coordinates each.
    cells
        Number of cells along each axis.
    unit
        Unit of length.

    Examples
    --------
    >>> make_box((0, 0, 0), (2, 1, 1), (4, 2, 2)).n_cells
    16
    """
    _require_box(lower, upper, cells)
    axes = [np.linspace(a, b, n + 1) for a, b, n in zip(lower, upper, cells, strict=True)]
    return _of_axes(axes, "box", unit)


def make_layers(
    lower: Sequence[float],
    upper: Sequence[float],
    cells: Sequence[int],
    *,
    growth: float = 1.2,
    unit: str = "",
) -> BackgroundMesh:
    """Return a box whose layers along the last axis become thicker from its lower side.

    Parameters
    ----------
    lower, upper, cells
        See `make_box`.
    growth
        Ratio of the thickness of a layer to that of the layer below; less than 1: thinner layers
        at the upper side.
    unit
        Unit of length.

    Examples
    --------
    >>> make_layers((0, 0), (1, 3), (1, 2), growth=2.0).points[:3, 1].tolist()
    [0.0, 1.0, 3.0]
    """
    _require_box(lower, upper, cells)
    _require(0.1 <= growth <= 10, f"a growth of {growth:g}", "a number from 0.1 to 10")
    axes = [np.linspace(a, b, n + 1) for a, b, n in zip(lower, upper, cells, strict=True)]
    thickness = growth ** np.arange(cells[-1], dtype=np.float64)
    share = np.append(0.0, np.cumsum(thickness)) / thickness.sum()
    axes[-1] = lower[-1] + (upper[-1] - lower[-1]) * share
    axes[-1][-1] = upper[-1]
    return _of_axes(axes, "layers", unit)


def make_cylinder(
    centre: Sequence[float],
    radius: float,
    height: float | None = None,
    *,
    core: int = 6,
    rings: int = 4,
    layers: int = 8,
    unit: str = "",
) -> BackgroundMesh:
    """Return a cylinder along z, or a disc, with a square core and rings around it (an O-grid).

    Parameters
    ----------
    centre
        Centre of its base: three coordinates; of a disc two.
    radius
        Its radius.
    height
        Its height; None: a disc of quads.
    core
        Cells along each side of the core.
    rings
        Rings of cells between the core and the rim.
    layers
        Layers of cells along the height.
    unit
        Unit of length.

    Examples
    --------
    >>> disc = make_cylinder((0, 0), 1.0, core=2, rings=2)
    >>> disc.n_cells, float(disc.jacobians.scaled.min().round(2))
    (20, 0.71)
    """
    dim = 2 if height is None else 3
    counts = (core, rings, layers)
    _require(len(centre) == dim, f"{len(centre)} coordinates", f"{dim} for its centre")
    _require(radius > 0 and (height or 1) > 0, f"radius {radius:g}", "lengths above 0")
    _require(min(counts) >= 1, f"{counts} cells", "at least 1 along the core, rings and layers")
    points, quads = _disc(core, rings)
    points = points * radius + np.asarray(centre[:2], dtype=np.float64)
    if height is None:
        return BackgroundMesh(points, quads, "disc", unit)
    levels = centre[2] + np.linspace(0.0, height, layers + 1)
    return _extrude(points, quads, levels, "cylinder", unit)


def _disc(core: int, rings: int) -> tuple[FloatArray, IntArray]:
    """Return the points and quads of the unit disc."""
    u = np.linspace(-_CORE, _CORE, core + 1)
    square = np.stack(np.meshgrid(u, u, indexing="ij"), axis=-1).reshape(-1, 2)
    n = core + 1
    number = np.arange(n * n).reshape(n, n)
    quads = [_quads_of(number)]
    loop = np.concatenate([number[:-1, 0], number[-1, :-1], number[:0:-1, -1], number[0, :0:-1]])
    angle = np.arctan2(square[loop, 1], square[loop, 0])
    outer = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points, previous = [square], loop
    for ring in range(1, rings + 1):
        share = ring / rings
        points.append((1 - share) * square[loop] + share * outer)
        after = n * n + (ring - 1) * len(loop) + np.arange(len(loop))
        turned = [np.roll(row, -1) for row in (previous, after)]
        quads.append(np.stack([previous, after, turned[1], turned[0]], axis=1))
        previous = after
    return np.concatenate(points), np.concatenate(quads).astype(np.int64)


def _quads_of(number: IntArray) -> IntArray:
    """Return the quads between the points of a rectangle, numbered with x along the first axis."""
    corners = (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    return np.stack([c.ravel() for c in corners], axis=1)


def _of_axes(axes: list[FloatArray], name: str, unit: str) -> BackgroundMesh:
    """Return the cells between coordinates along each axis, in C order."""
    shape = tuple(len(a) for a in axes)
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))
    number = np.arange(len(points), dtype=np.int64).reshape(shape)
    if len(axes) == 2:
        return BackgroundMesh(points, _quads_of(number), name, unit)
    corners = [
        number[a : shape[0] - 1 + a, b : shape[1] - 1 + b, c : shape[2] - 1 + c].ravel()
        for c in (0, 1)
        for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]
    return BackgroundMesh(points, np.stack(corners, axis=1), name, unit)


def _extrude(
    points: FloatArray, quads: IntArray, levels: FloatArray, name: str, unit: str
) -> BackgroundMesh:
    """Return the hexes between copies of quads at several heights."""
    n = len(points)
    height = np.repeat(levels, n)
    spread = np.column_stack([np.tile(points, (len(levels), 1)), height])
    hexes = [np.hstack([quads + k * n, quads + (k + 1) * n]) for k in range(len(levels) - 1)]
    return BackgroundMesh(spread, np.concatenate(hexes), name, unit)


def _require_box(lower: Sequence[float], upper: Sequence[float], cells: Sequence[int]) -> None:
    fits = len(lower) == len(upper) == len(cells) and len(cells) in (2, 3)
    found = f"corners {tuple(lower)} and {tuple(upper)} with {tuple(cells)} cells"
    _require(fits, found, "two or three numbers in each")
    is_box = all(a < b for a, b in zip(lower, upper, strict=True)) and min(cells) >= 1
    _require(is_box, found, "lower corners below the upper ones, and at least one cell per axis")


def _require(holds: bool, found: str, expected: str) -> None:
    if not holds:
        raise ConfigError(
            found, where="background mesh", expected=expected, remedy="correct the arguments"
        )
