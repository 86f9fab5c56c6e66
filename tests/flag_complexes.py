"""The paper's complex of kept cells whose contacts have votes, by definition and with gudhi."""

import itertools

import gudhi
import numpy as np
from scipy import ndimage


def is_pinched(block):
    """Return whether kept cells, or empty ones, of the cells around a place are not connected."""
    block = np.squeeze(block)
    if block.ndim < 2:
        return False
    return any(ndimage.label(side)[1] > 1 for side in (block, ~block))


def around(cells, place):
    """Return the cells around a place of the doubled grid."""
    return cells[np.ix_(*[[i // 2] if i % 2 else [i // 2 - 1, i // 2] for i in place])]


def betti_by_flag_complex(kept, votes):
    """Return the Betti numbers of kept cells whose pinches follow their votes."""
    kept, votes, dim = np.pad(kept, 1), np.pad(votes, 2), kept.ndim
    nodes = []
    for place in itertools.product(*[range(1, n - 1) for n in votes.shape]):
        if sum(i % 2 for i in place) == dim - 1:  # Faces, in the plane edges, have no node.
            continue
        cells = around(kept, place)
        if votes[place] if is_pinched(cells) else cells.any():
            nodes.append(place)
    return betti_of(nodes)


def betti_of(nodes):
    """Return the Betti numbers of the complex of some places of the doubled grid."""
    number = {place: i for i, place in enumerate(nodes)}
    dim = len(nodes[0]) if nodes else 2
    steps = list(itertools.product(range(-2, 3), repeat=dim))
    tree = gudhi.SimplexTree()
    for place, i in number.items():
        tree.insert([i])
        for step in steps:
            other = tuple(a + s for a, s in zip(place, step, strict=True))
            if number.get(other, -1) > i and is_joined(place, other):
                tree.insert([i, number[other]])
    tree.expansion(dim)
    tree.compute_persistence(persistence_dim_max=True)
    return tuple([*tree.betti_numbers(), 0, 0, 0][:3])


def is_joined(p, q):
    """Return whether two places are cells with a common face, or one lies on the other."""
    differ = [abs(a - b) for a, b in zip(p, q, strict=True)]
    if all(i % 2 for i in (*p, *q)):
        return max(differ) == 2 == sum(differ)
    return max(differ) == 1 and any(
        all(x == y or (x % 2 == 0 and y % 2 == 1) for x, y in zip(a, b, strict=True))
        for a, b in ((p, q), (q, p))
    )


def has_contractible_link(kept, votes, cell):
    """Return whether the link of a cell is contractible, by the homology of a complex of gudhi.

    An edge or vertex that is a pinch with or without the cell has its vote, any other one is there
    if another kept cell touches it.
    """
    kept, votes = np.pad(kept, 1), np.pad(votes, 2)
    cell = tuple(i + 1 for i in cell)
    without, with_cell = kept.copy(), kept.copy()
    without[cell], with_cell[cell] = False, True
    nodes = []
    for step in itertools.product((-1, 0, 1), repeat=kept.ndim):
        place = tuple(2 * i + 1 + s for i, s in zip(cell, step, strict=True))
        others = around(without, place)
        if sum(map(abs, step)) == 0:
            continue
        if is_pinched(others) or is_pinched(around(with_cell, place)):
            if votes[place]:
                nodes.append(place)
        elif others.any():
            nodes.append(place)
    # The cell across a face stands for the face.
    return bool(nodes) and betti_of_link(nodes) == (1, 0, 0)


def betti_of_link(nodes):
    """Return the Betti numbers of places on the boundary of a cell; faces stand for themselves."""
    tree = gudhi.SimplexTree()
    for i, p in enumerate(nodes):
        tree.insert([i])
        for j, q in enumerate(nodes[:i]):
            for a, b in ((p, q), (q, p)):
                # Place a lies on place b, which extends along every axis where they differ.
                if all(x == y or (x % 2 == 0 and y % 2 == 1) for x, y in zip(a, b, strict=True)):
                    tree.insert([i, j])
    tree.expansion(2)
    tree.compute_persistence(persistence_dim_max=True)
    return tuple([*tree.betti_numbers(), 0, 0, 0][:3])
