"""Choose colours for materials, which figures and the explorer share."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from functools import cache

import numpy as np

from tusqh.figures.theme import PALETTE
from tusqh.grid import FloatArray

#: Colours of the first materials: those of `PALETTE` without grey, which the void has, and without
#: brown, which is near orange; orange comes first, as land and water are often the two of a map.
_FIRST = (PALETTE[1], PALETTE[0], *PALETTE[2:5], PALETTE[6], *PALETTE[8:])

_BLUE = PALETTE[0]

#: Colour of the void, where it is meshed.
VOID_COLOUR = "#d9d9d9"

#: Most colours that differ; further materials have them again.
MOST = 100


def material_colours(n: int, *, has_void: bool = False) -> list[str]:
    """Return a colour for each of n materials, as ``#rrggbb``.

    The first eight are colours that colour-blind people can distinguish; every further one is,
    among bright colours, the one farthest from all before it in the space OKLab.

    Parameters
    ----------
    n
        Number of materials.
    has_void
        Whether the last one is the void, which is light grey.

    References
    ----------
    B. Ottosson, A perceptual color space for image processing (2020),
    https://bottosson.github.io/posts/oklab

    Examples
    --------
    >>> material_colours(3, has_void=True)
    ['#de8f05', '#0173b2', '#d9d9d9']
    """
    colours = [_listed()[k % MOST] for k in range(n)]
    return [*colours[:-1], VOID_COLOUR] if has_void else colours


def colours_of(names: Sequence[str]) -> list[str]:
    """Return a colour for each material, blue for one called water; the last one is the void.

    Parameters
    ----------
    names
        The materials.

    Examples
    --------
    >>> colours_of(["water", "land", "void"])
    ['#0173b2', '#de8f05', '#d9d9d9']
    """
    colours = material_colours(len(names), has_void=True)
    if "water" in names[:-1]:
        water = list(names).index("water")
        if _BLUE in colours:
            colours[colours.index(_BLUE)] = colours[water]
        colours[water] = _BLUE
    return colours


def to_rgb(colours: list[str]) -> FloatArray:
    """Return colours as red, green and blue from 0 to 1, shape (n, 3).

    Parameters
    ----------
    colours
        Colours as ``#rrggbb``.

    Examples
    --------
    >>> to_rgb(["#ff0033"]).tolist()
    [[1.0, 0.0, 0.2]]
    """
    return np.array([[int(c[i : i + 2], 16) / 255 for i in (1, 3, 5)] for c in colours])


def to_oklab(rgb: FloatArray) -> FloatArray:
    """Return colours in the space OKLab, where distances are those that people see, shape (n, 3).

    Parameters
    ----------
    rgb
        Red, green and blue from 0 to 1, shape (n, 3).

    Examples
    --------
    >>> (to_oklab(np.ones((1, 3))).round(3) + 0.0).tolist()
    [[1.0, 0.0, 0.0]]
    """
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    return np.asarray(np.cbrt(linear @ _TO_CONES.T) @ _TO_LAB.T)


#: Matrices of the definition of OKLab.
_TO_CONES = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
_TO_LAB = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)


@cache
def _listed() -> tuple[str, ...]:
    """Return `MOST` colours, each far from those before it."""
    steps = np.arange(32, 256, 32) - 1
    candidates = np.array(list(itertools.product(steps, repeat=3))) / 255
    lab = to_oklab(candidates)
    # Lines and shades must be seen on them, and they on white.
    is_fit = (lab[:, 0] >= 0.5) & (lab[:, 0] <= 0.9) & (np.hypot(lab[:, 1], lab[:, 2]) >= 0.06)
    candidates, lab = candidates[is_fit], lab[is_fit]
    found = list(_FIRST)
    taken = to_oklab(to_rgb([*_FIRST, VOID_COLOUR, "#ffffff"]))
    nearest = np.linalg.norm(lab[:, None] - taken, axis=2).min(axis=1)
    while len(found) < MOST:
        best = int(nearest.argmax())
        found.append("#" + "".join(f"{round(255 * c):02x}" for c in candidates[best]))
        nearest = np.minimum(nearest, np.linalg.norm(lab - lab[best], axis=1))
    return tuple(found)
