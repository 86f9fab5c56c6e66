"""Raise the smallest scaled Jacobians of hexes, at some cost to the distance around the worst."""

from __future__ import annotations

import logging

import numpy as np

from tusqh.fitting.moving import Moving
from tusqh.fitting.validity import find_unproven
from tusqh.grid import BoolArray, FloatArray

_LOG = logging.getLogger("tusqh")

#: Scaled Jacobians that the polish wishes for, first and later.
_WISH, _LATER_WISH = 0.6, 0.7
#: Rounds: those in which all hexes count, and all.
_WIDE, _ROUNDS = 4, 24
#: Scaled Jacobian that ends the later rounds where more than this share of the hexes is bad: there
#: the distance matters more.
_LEAST, _MANY = 0.35, 0.005
#: Factor of the weights around bad hexes in each round, and the weight that they keep.
RELEASE, _KEPT = 0.25, 0.1


def polish(
    moving: Moving,
    enough: FloatArray,
    held: BoolArray | None = None,
    release: FloatArray | None = None,
) -> None:
    """Move vertices so that the worst hexes become better.

    In the first rounds all hexes below the wish count, then only those that are not yet good enough
    and their neighbours; the few worst if that is a large share of the mesh.  Fit terms around
    hexes that stay bad become weaker.

    Parameters
    ----------
    moving
        The hexes; change in place.
    enough
        Scaled Jacobian with which each hex is good enough, shape (m,).
    held
        Vertices whose fit terms keep their weights, shape (n,); None: none.
    release
        Factor of the weight of each vertex around bad hexes in each round, shape (n,), where there
        are feature edges; hexes that are not proven to be free of folds are bad, too.  None: all
        `RELEASE`.
    """
    for round_ in range(_ROUNDS):
        scaled = moving.quality.scaled
        is_bad = scaled < enough
        is_wide = round_ < _WIDE
        if not is_wide and is_bad.mean() > _MANY:
            is_bad &= scaled < _LEAST
        if release is not None:
            is_bad |= find_unproven(moving.points, moving.cells)
        if not is_bad.any():
            return
        around = np.zeros(len(moving.points), dtype=np.bool_)
        around[moving.cells[is_bad]] = True
        moving.moved[:] = 0.0
        if is_wide:
            moving.moved[moving.cells[scaled < _WISH]] = 1.0
        else:
            moving.moved[moving.spread(around, 2)] = 1.0
            around = moving.spread(around, 1)
        if round_ > 0:
            if held is not None:
                around &= ~held
            weight = moving.weight[around]
            factor = RELEASE if release is None else release[around]
            moving.weight[around] = np.maximum(factor * weight, np.minimum(weight, _KEPT))
        moving.sweep(4, wish=_WISH if is_wide else _LATER_WISH, longest=0.1)
        _LOG.debug("polished: least scaled Jacobian %.4f", moving.quality.scaled.min())
