"""Predict the Betti numbers of every material from labels and decisions alone.

The complex of a material consists of its cells, the faces between them, the edges and vertices with
only its cells around them, and the contacts decided for it.  One union-find gives the components of
all materials.  The complement of a material retracts onto the complexes of the others, so its voids
(in 2D its holes) are the components of the graph of touching components without its own, less the
outside.  Its holes in 3D follow from the Euler characteristic, which is counted.
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.contacts.decided import Contacts, Labels
from tusqh.contacts.octants import octants
from tusqh.contacts.planar import find_diagonals
from tusqh.grid import BoolArray, IntArray
from tusqh.grid.components import label_components
from tusqh.topology.betti_numbers import BettiNumbers


def predict_betti(labels: Labels, contacts: Contacts, n_materials: int) -> list[BettiNumbers]:
    """Return the Betti numbers of every material.

    Parameters
    ----------
    labels
        Material of every cell; all cells of the outermost layer have the material that fills the
        outside.
    contacts
        The decisions at all contacts.
    n_materials
        Number of materials.

    Examples
    --------
    >>> labels = np.ones((5, 5), dtype=np.int32)
    >>> labels[1, 1] = labels[2, 2] = labels[3, 1] = 0
    >>> balls = Contacts(np.array([[6, 11, 12, 7], [11, 16, 17, 12]]), np.array([0, 1]),
    ...                  np.empty((2, 0)), np.empty((0, 4), dtype=int), np.empty(0))
    >>> [str(betti) for betti in predict_betti(labels, balls, 2)]
    ['(2, 0, 0)', '(1, 2, 0)']
    """
    component = find_components(labels, contacts)
    names, numbers = _number_components(component.ravel())
    numbers = numbers.reshape(labels.shape)
    material_of = labels.ravel()[names]
    pairs = _find_touching(numbers, labels, contacts)
    # The outside is one more component, of no material.
    outside = len(names)
    pairs = np.concatenate([pairs, [[numbers.flat[0], outside]]])
    n_components = np.bincount(material_of, minlength=n_materials)
    enclosed = [
        _count_without(pairs, np.append(material_of == k, False)) - 1 for k in range(n_materials)
    ]
    if labels.ndim == 2:
        return [BettiNumbers(int(n), e) for n, e in zip(n_components, enclosed, strict=True)]
    euler = count_euler(labels, contacts, n_materials)
    return [
        BettiNumbers(int(n), int(n) + e - int(x), e)
        for n, e, x in zip(n_components, enclosed, euler, strict=True)
    ]


def predict_solid(labels: Labels, contacts: Contacts, void: int) -> BettiNumbers:
    """Return the Betti numbers of the union of all materials except the void.

    Parameters
    ----------
    labels
        Material of every cell, as for `predict_betti`.
    contacts
        The decisions at all contacts.
    void
        Index of the void.
    """
    merged = (labels == void).astype(np.int32)
    around = merged.ravel()[contacts.vertex_cells]
    if labels.ndim == 2:
        is_pinched = find_diagonals(around.T)
    else:
        is_pinched = octants().is_pinched[around @ (1 << np.arange(8))]
    on_edge = find_diagonals(merged.ravel()[contacts.edge_cells].T)
    both = Contacts(
        vertex_cells=contacts.vertex_cells[is_pinched],
        ball=(contacts.ball[is_pinched] == void).astype(np.int32),
        sticks=(contacts.sticks[is_pinched] == void).astype(np.int32),
        edge_cells=contacts.edge_cells[on_edge],
        edge_material=(contacts.edge_material[on_edge] == void).astype(np.int32),
    )
    return predict_betti(merged, both, 2)[0]


def count_euler(labels: Labels, contacts: Contacts, n_materials: int) -> IntArray:
    """Return the Euler characteristic of every material in 3D, shape (n_materials,).

    Parameters
    ----------
    labels
        Material of every cell.
    contacts
        The decisions at all contacts.
    n_materials
        Number of materials.
    """
    euler: IntArray = _count_blocks(np.ascontiguousarray(labels), n_materials)
    flat = labels.ravel()
    euler += np.bincount(
        contacts.edge_material,
        weights=_euler_of_edges(flat[contacts.edge_cells], contacts.edge_material),
        minlength=n_materials,
    ).astype(np.int64)
    links = 1 - _euler_of_links(flat[contacts.vertex_cells], contacts.sticks, contacts.ball)
    euler += np.bincount(contacts.ball, weights=links, minlength=n_materials).astype(np.int64)
    return euler


def _euler_of_edges(around: Labels, material: Labels) -> IntArray:
    """Return the contribution of a stick to its material's Euler characteristic, shape (e,)."""
    own = around == material[:, None]
    n_faces = (own & np.roll(own, -1, axis=1)).sum(axis=1)
    return np.asarray(1 - (own.sum(axis=1) - n_faces), dtype=np.int64)


def _euler_of_links(around: Labels, sticks: Labels, ball: Labels) -> IntArray:
    """Return the Euler characteristic of the contact of balls with their material, shape (p,)."""
    tables = octants()
    own = around == ball[:, None]
    euler = tables.euler[own @ (1 << np.arange(8))]
    for half_edge in range(6):
        four = around[:, tables.around[half_edge]]
        touches = own[:, tables.around[half_edge]].any(axis=1)
        is_pinched = find_diagonals(four.T)
        is_full = own[:, tables.around[half_edge]].all(axis=1)
        joins = is_pinched & touches & (sticks[:, half_edge] == ball)
        euler = euler + is_full + np.where(joins, _euler_of_edges(four, ball), 0)
    return np.asarray(euler, dtype=np.int64)


def find_components(labels: Labels, contacts: Contacts) -> NDArray[np.int32]:
    """Return the component of every cell as its lowest flat cell, shape n.

    Parameters
    ----------
    labels
        Material of every cell.
    contacts
        The decisions at all contacts.
    """
    layer = labels if labels.ndim == 3 else labels[None]
    parent = np.arange(labels.size, dtype=np.int32)
    flat = np.ascontiguousarray(layer).ravel()
    _join_faces(flat, np.array(layer.shape), parent)
    for cells, material in (
        (contacts.edge_cells, contacts.edge_material),
        (contacts.vertex_cells, contacts.ball),
    ):
        _join_contacts(flat, cells, material, parent)
    _flatten(parent)
    return parent.reshape(labels.shape)


def _find_touching(numbers: NDArray[np.int32], labels: Labels, contacts: Contacts) -> IntArray:
    """Return the pairs of components that touch, shape (r, 2)."""
    n = int(numbers.max()) + 1
    layer = numbers if numbers.ndim == 3 else numbers[None]
    keys = [np.unique(_touching_pairs(np.ascontiguousarray(layer), n))]
    flat, materials = numbers.ravel(), labels.ravel()
    for cells, material in (
        (contacts.edge_cells, contacts.edge_material),
        (contacts.vertex_cells, contacts.ball),
    ):
        own = (materials[cells] == material[:, None]).argmax(axis=1)
        centre = flat[np.take_along_axis(cells, own[:, None], axis=1)].astype(np.int64)
        keys.append(np.unique(centre * n + flat[cells]))
    return np.stack(np.divmod(np.unique(np.concatenate(keys)), n), axis=1)


def _count_without(pairs: IntArray, is_left_out: BoolArray) -> int:
    """Return the number of components of a graph without some of its nodes."""
    kept = pairs[~is_left_out[pairs].any(axis=1)]
    n = len(is_left_out)
    return label_components(kept[:, 0], kept[:, 1], n)[1] - int(is_left_out.sum())


@numba.njit(cache=True)
def _root(parent, a):  # type: ignore[no-untyped-def]
    while parent[a] != a:
        parent[a] = parent[parent[a]]
        a = parent[a]
    return a


@numba.njit(cache=True)
def _join(parent, a, b):  # type: ignore[no-untyped-def]
    a, b = _root(parent, a), _root(parent, b)
    if a < b:
        parent[b] = a
    elif b < a:
        parent[a] = b


@numba.njit(cache=True)
def _join_faces(flat, shape, parent):  # type: ignore[no-untyped-def]
    """Join cells of one material across faces."""
    n_y, n_z = shape[1], shape[2]
    for i in range(shape[0]):
        for j in range(n_y):
            for k in range(n_z):
                at = (i * n_y + j) * n_z + k
                if k > 0 and flat[at] == flat[at - 1]:
                    _join(parent, at, at - 1)
                if j > 0 and flat[at] == flat[at - n_z]:
                    _join(parent, at, at - n_z)
                if i > 0 and flat[at] == flat[at - n_y * n_z]:
                    _join(parent, at, at - n_y * n_z)


@numba.njit(cache=True)
def _number_components(component):  # type: ignore[no-untyped-def]
    """Return the lowest cell of every component, ascending, and the component of every cell."""
    numbers = np.empty_like(component)
    names, n = np.empty(1024, dtype=np.int64), 0
    for a in range(len(component)):
        if component[a] == a:
            if n == len(names):
                names = np.concatenate((names, np.empty_like(names)))
            names[n] = a
            numbers[a] = n
            n += 1
        else:
            numbers[a] = numbers[component[a]]
    return names[:n].copy(), numbers


@numba.njit(cache=True)
def _touching_pairs(numbers, n):  # type: ignore[no-untyped-def]
    """Return keys of the pairs of components across faces, each at least once."""
    keys, size = np.empty(1024, dtype=np.int64), 0
    last = np.full(3, -1, dtype=np.int64)
    for i in range(numbers.shape[0]):
        for j in range(numbers.shape[1]):
            for k in range(numbers.shape[2]):
                own = np.int64(numbers[i, j, k])
                for axis in range(3):
                    if axis == 0:
                        other = numbers[i - 1, j, k] if i > 0 else own
                    elif axis == 1:
                        other = numbers[i, j - 1, k] if j > 0 else own
                    else:
                        other = numbers[i, j, k - 1] if k > 0 else own
                    key = other * n + own
                    if other == own or key == last[axis]:
                        continue
                    last[axis] = key
                    if size == len(keys):
                        keys = np.concatenate((keys, np.empty_like(keys)))
                    keys[size] = key
                    size += 1
    return keys[:size].copy()


@numba.njit(cache=True)
def _count_blocks(labels, n_materials):  # type: ignore[no-untyped-def]
    """Return cells minus faces plus edges minus vertices between cells of one material."""
    euler = np.zeros(n_materials, dtype=np.int64)
    n_x, n_y, n_z = labels.shape
    for i in range(n_x):
        for j in range(n_y):
            for k in range(n_z):
                own = labels[i, j, k]
                x = i + 1 < n_x and labels[i + 1, j, k] == own
                y = j + 1 < n_y and labels[i, j + 1, k] == own
                z = k + 1 < n_z and labels[i, j, k + 1] == own
                xy = x and y and labels[i + 1, j + 1, k] == own
                xz = x and z and labels[i + 1, j, k + 1] == own
                yz = y and z and labels[i, j + 1, k + 1] == own
                xyz = xy and xz and yz and labels[i + 1, j + 1, k + 1] == own
                euler[own] += 1 - x - y - z + xy + xz + yz - xyz
    return euler


@numba.njit(cache=True)
def _join_contacts(flat, cells, material, parent):  # type: ignore[no-untyped-def]
    """Join the cells around every contact that have its material."""
    for i in range(len(cells)):
        first = -1
        for cell in cells[i]:
            if flat[cell] == material[i]:
                if first < 0:
                    first = cell
                _join(parent, first, cell)


@numba.njit(cache=True)
def _flatten(parent):  # type: ignore[no-untyped-def]
    """Point every cell to the lowest one of its component."""
    for a in range(len(parent)):
        parent[a] = parent[parent[a]]
