"""The elements that files may have: linear or quadratic, and their types in Abaqus."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tusqh.errors import ConfigError
from tusqh.grid import IntArray
from tusqh.meshes.facets import HEX_EDGES, HEX_FACETS, QUAD_FACETS

#: Names of meshio for elements and their facets, by the number of nodes.
_NAMES = {
    4: ("quad", "line"),
    8: ("hexahedron", "quad"),
    20: ("hexahedron20", "quad8"),
    27: ("hexahedron27", "quad9"),
}
_NAMES_OF_PLANE = {4: ("quad", "line"), 8: ("quad8", "line3"), 9: ("quad9", "line3")}

#: Dimension, number of nodes and type in Abaqus of every element that may be asked for.
ELEMENTS: dict[str, tuple[int, int, str]] = {
    "quad4": (2, 4, "CPS4"),
    "quad8": (2, 8, "CPS8"),
    "quad9": (2, 9, ""),
    "hex8": (3, 8, "C3D8"),
    "hex20": (3, 20, "C3D20"),
    "hex27": (3, 27, ""),
    **{name: (3, 8, name) for name in ("C3D8", "C3D8R", "C3D8I", "C3D8H", "DC3D8")},
    **{name: (3, 20, name) for name in ("C3D20", "C3D20R", "C3D20H", "DC3D20")},
    **{name: (2, 4, name) for name in ("CPS4", "CPS4R", "CPS4I", "CPE4", "CPE4R", "CPE4I")},
    **{name: (2, 4, name) for name in ("CAX4", "CAX4R", "DC2D4", "DCAX4")},
    **{name: (2, 8, name) for name in ("CPS8", "CPS8R", "CPE8", "CPE8R")},
    **{name: (2, 8, name) for name in ("CAX8", "CAX8R", "DC2D8", "DCAX8")},
}


@dataclass(frozen=True)
class Element:
    """The kind of all elements of a file.

    Parameters
    ----------
    dim
        Dimension, 2 or 3.
    n_nodes
        Nodes of an element: 4, 8 or 9 in the plane, 8, 20 or 27 in space.
    abaqus
        Type in Abaqus; empty if there is none.
    """

    dim: int
    n_nodes: int
    abaqus: str

    @classmethod
    def of(cls, name: str | None, dim: int) -> Element:
        """Return the element of a name; None: the linear one.

        Parameters
        ----------
        name
            A key of `ELEMENTS`, in capitals or small letters.
        dim
            Dimension of the mesh.

        Raises
        ------
        ConfigError
            The name is unknown, or has another dimension.

        Examples
        --------
        >>> Element.of("c3d20r", 3)
        Element(dim=3, n_nodes=20, abaqus='C3D20R')
        """
        wanted = name or ("quad4" if dim == 2 else "hex8")
        found = {key.lower(): value for key, value in ELEMENTS.items()}.get(wanted.lower())
        if found is None or found[0] != dim:
            problem = "is not known" if found is None else f"is for meshes in {found[0]}D"
            raise ConfigError(
                f"the element {wanted!r} {problem}",
                where="option --element",
                expected="one of "
                + ", ".join(key for key, value in ELEMENTS.items() if value[0] == dim),
                remedy="change the name",
            )
        return cls(*found)

    @property
    def is_quadratic(self) -> bool:
        """Whether the element has middle nodes."""
        return bool(self.n_nodes > 2**self.dim)

    @property
    def names(self) -> tuple[str, str]:
        """The names of meshio for the element and its facets."""
        return (_NAMES_OF_PLANE if self.dim == 2 else _NAMES)[self.n_nodes]

    @property
    def facets(self) -> IntArray:
        """Local nodes of every facet, which faces outwards: corners, then middle nodes."""
        corners = QUAD_FACETS if self.dim == 2 else HEX_FACETS
        if not self.is_quadratic:
            return corners
        if self.dim == 2:
            return np.column_stack([corners, 4 + np.arange(4)])
        number = {frozenset(edge): 8 + k for k, edge in enumerate(HEX_EDGES.tolist())}
        middle = [
            [number[frozenset((facet[k], facet[(k + 1) % 4]))] for k in range(4)]
            for facet in corners.tolist()
        ]
        centre = 20 + np.arange(6)[:, None]
        return np.hstack([corners, middle, *([centre] if self.n_nodes == 27 else [])])


def require_element(name: str | None) -> None:
    """Raise an error if no mesh has elements of this name.

    Parameters
    ----------
    name
        A key of `ELEMENTS`, in capitals or small letters; None: linear elements.

    Raises
    ------
    ConfigError
        The name is unknown.
    """
    if name is not None and name.lower() not in {key.lower() for key in ELEMENTS}:
        raise ConfigError(
            f"the element {name!r} is not known",
            where="option --element",
            expected="one of " + ", ".join(ELEMENTS),
            remedy="change the name",
        )


def order_of(
    n_nodes: int, corners: list[int], edges: list[tuple[int, int]], faces: list[tuple[int, ...]]
) -> IntArray:
    """Return the nodes of VTK's hexes in the order of another format.

    Parameters
    ----------
    n_nodes
        Nodes of the element: 8, 20 or 27.
    corners
        The corner of VTK at every corner of the format.
    edges
        Ends of the edges of the format, whose middle nodes follow the corners, as corners of the
        format.
    faces
        Corners of the faces of the format, whose centres follow, as corners of the format; ``()``
        is the centre of the hex.

    Examples
    --------
    >>> order_of(8, [0, 3, 2, 1, 4, 7, 6, 5], [], []).tolist()
    [0, 3, 2, 1, 4, 7, 6, 5]
    """
    if n_nodes == 8:
        return np.array(corners)
    number = {frozenset(edge): 8 + k for k, edge in enumerate(HEX_EDGES.tolist())}
    number |= {frozenset(facet): 20 + k for k, facet in enumerate(HEX_FACETS.tolist())}
    number[frozenset()] = 26
    parts = [*edges, *(faces if n_nodes == 27 else [])]
    return np.array([*corners, *(number[frozenset(corners[k] for k in part)] for part in parts)])
