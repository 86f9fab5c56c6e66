"""The position and resolution of the background grid."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from tusqh.settings.field import setting
from tusqh.settings.section import Section
from tusqh.settings.validate import Path

Place = Literal["auto", "corner"]
Align = Literal["faces", "principal"]
Box = tuple[tuple[float, ...], tuple[float, ...]]


@dataclass(frozen=True)
class Grid(Section):
    """The background grid of square or cubic cells over the window or the bounding box.

    Examples
    --------
    >>> Grid(cell_size=0.5).placement
    'auto'
    >>> Grid().cells
    64
    """

    title: ClassVar[str] = "Grid"
    alternatives: ClassVar[tuple[str, ...]] = ("cells", "cell_size")

    cells: int | tuple[int, ...] | None = setting(
        "Number of cells along the longest side, or one number for each axis.",
        default=None,
        otherwise=64,
        at_least=1,
        n_items=(2, 3),
        metavar="N",
    )
    cell_size: float | tuple[float, ...] | None = setting(
        "Edge length of a cell, instead of `cells`, or one for each axis: cells are boxes.",
        default=None,
        unit="units of the geometry",
        above=0,
        n_items=(2, 3),
        metavar="H",
    )
    placement: Place = setting(
        "`auto` moves the grid by part of a cell where the volume is more than 1 % off, to the "
        "place with the least error; `corner` lays it on the box. Over images it is not moved.",
        default="auto",
    )
    offset: tuple[float, ...] | None = setting(
        "How far the grid is moved along each axis from the corner of the box, instead of "
        "`placement`.",
        default=None,
        otherwise="as `placement` says",
        unit="cells",
        above=-1,
        below=1,
        n_items=(2, 3),
        metavar="X,Y,Z",
        kinds=("outline", "surface"),
    )
    snap: bool = setting(
        "Lay planes of the grid on plane faces of the geometry, instead of `placement`; where that "
        "is necessary, cells become up to 1.5 times as large or small.",
        default=False,
        kinds=("outline", "surface"),
    )

    rotate: tuple[float, ...] | None = setting(
        "How the axes of the grid are turned: one angle in the plane, in space three angles about "
        "x, then y, then z; or a rotation matrix, whose rows are these axes.",
        default=None,
        otherwise="they are those of the coordinates",
        unit="degrees",
        n_items=(1, 9),
        metavar="A,B,C",
        kinds=("outline", "surface"),
    )
    align: Align | None = setting(
        "Turn the axes of the grid to the directions with the most area of plane `faces`, or to "
        "the `principal` axes of the surface.",
        default=None,
        otherwise="as `rotate` says",
        kinds=("outline", "surface"),
    )

    @property
    def is_turned(self) -> bool:
        """Whether the settings turn the axes of the grid."""
        return self.rotate is not None or self.align is not None

    def find_contradictions(self) -> Iterator[tuple[Path, str, str]]:
        """Yield settings that both place or both turn the grid."""
        if self.rotate is not None and self.align is not None:
            yield (), "found `rotate` and `align`", "one of the two"
        if self.snap and self.offset is not None:
            yield (), "found `snap` and `offset`", "one of the two"
        if self.snap and isinstance(self.cells, tuple):
            found = f"found `snap` and cells of {list(self.cells)}"
            yield (), found, "one number of cells, or `cell_size`: `snap` may change the size"


@dataclass(frozen=True)
class Window(Section):
    """The box in which to mesh; there is no material outside it.

    Examples
    --------
    >>> Window.from_dict({"lower": [0, 1], "upper": [2, 3]}).box
    ((0.0, 1.0), (2.0, 3.0))
    """

    title: ClassVar[str] = "Grid"

    #: How the option is written.
    option_form: ClassVar[str] = " As X0,Y0,X1,Y1; in 3D, six numbers."

    lower: tuple[float, ...] = setting("Lowest corner, `[x, y]` or `[x, y, z]`.", n_items=(2, 3))
    upper: tuple[float, ...] = setting("Highest corner.", n_items=(2, 3))

    @property
    def box(self) -> Box:
        """The two corners."""
        return self.lower, self.upper

    rotate: tuple[float, ...] | None = setting(
        "How the axes of the grid are turned: one angle in the plane, in space three angles about "
        "x, then y, then z; or a rotation matrix, whose rows are these axes.",
        default=None,
        otherwise="they are those of the coordinates",
        unit="degrees",
        n_items=(1, 9),
        metavar="A,B,C",
        kinds=("outline", "surface"),
    )
    align: Align | None = setting(
        "Turn the axes of the grid to the directions with the most area of plane `faces`, or to "
        "the `principal` axes of the surface.",
        default=None,
        otherwise="as `rotate` says",
        kinds=("outline", "surface"),
    )

    @property
    def is_turned(self) -> bool:
        """Whether the settings turn the axes of the grid."""
        return self.rotate is not None or self.align is not None

    def find_contradictions(self) -> Iterator[tuple[Path, str, str]]:
        """Yield corners that do not span a box."""
        found = f"found {list(self.lower)} and {list(self.upper)}"
        if len(self.lower) != len(self.upper):
            yield (), found, "as many coordinates in `lower` as in `upper`"
        elif any(low >= high for low, high in zip(self.lower, self.upper, strict=True)):
            yield (), found, "`upper` above `lower` along every axis"

    @staticmethod
    def from_argument(value: Any) -> Any:
        """Return the value of the argument `window`, lowest and highest corner, as a mapping.

        Parameters
        ----------
        value
            The two corners.

        Raises
        ------
        ValueError
            The value is of another kind; the message states what is expected.

        Examples
        --------
        >>> Window.from_argument([(0, 0), (4, 3)])
        {'lower': (0, 0), 'upper': (4, 3)}
        """
        if isinstance(value, (Window, dict)):
            return value
        try:
            lower, upper = value
        except (TypeError, ValueError):
            raise ValueError("the lowest and the highest corner of a box") from None
        return {"lower": lower, "upper": upper}

    @staticmethod
    def from_option(text: str) -> Any:
        """Return the text of the option ``--window`` as a mapping.

        Parameters
        ----------
        text
            Coordinates of the lowest and of the highest corner, separated by commas.

        Raises
        ------
        ValueError
            The value is of another kind; the message states what is expected.

        Examples
        --------
        >>> Window.from_option("0,0,4,3")
        {'lower': [0.0, 0.0], 'upper': [4.0, 3.0]}
        """
        try:
            numbers = [float(entry) for entry in text.split(",")]
        except ValueError:
            numbers = []
        if len(numbers) not in (4, 6):
            raise ValueError("a box as X0,Y0,X1,Y1, or as X0,Y0,Z0,X1,Y1,Z1 in 3D")
        half = len(numbers) // 2
        return {"lower": numbers[:half], "upper": numbers[half:]}

    def to_option(self) -> str:
        """Return the text of the option ``--window``."""
        return ",".join(repr(x).removesuffix(".0") for x in (*self.lower, *self.upper))
