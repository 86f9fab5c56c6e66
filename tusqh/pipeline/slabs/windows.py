"""The decisions at the contacts of a grid on disk, one part for the elements of each slab."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tusqh.atomic import replacing
from tusqh.contacts.decided import Contacts
from tusqh.contacts.slab_elements import window_of
from tusqh.contacts.spatial import SpatialDecision
from tusqh.contacts.spatial_votes import LAYERS
from tusqh.contacts.stick_field import Field
from tusqh.grid import BackgroundGrid
from tusqh.grid.slabs import Slab

#: Elements do not depend on the list of contacts.
_NO_CONTACTS = Contacts(
    vertex_cells=np.empty((0, 8), dtype=np.int64),
    ball=np.empty(0, dtype=np.int32),
    sticks=np.empty((0, 6), dtype=np.int32),
    edge_cells=np.empty((0, 4), dtype=np.int64),
    edge_material=np.empty(0, dtype=np.int32),
)


def write_windows(
    path: Path, decision: SpatialDecision, grid: BackgroundGrid, slabs: Sequence[Slab]
) -> None:
    """Write the part of a decision for each slab; the file appears complete or not at all.

    Parameters
    ----------
    path
        The npz file.
    decision
        The decision of the whole grid, without bridges.
    grid
        The whole grid.
    slabs
        Its slabs.
    """
    assert decision.bridged is None
    arrays: dict[str, NDArray[Any]] = {}
    for slab in slabs:
        field = window_of(decision, grid, slab).field
        arrays |= {_name(slab, name): getattr(field, name) for name in Field._fields}
    with replacing(path) as temporary:
        np.savez_compressed(temporary, **arrays)  # type: ignore[arg-type]


def read_window(path: Path, grid: BackgroundGrid, slab: Slab) -> SpatialDecision:
    """Return the part of a decision for a slab, as `window_of` does but without contacts.

    Parameters
    ----------
    path
        The file of `write_windows`.
    grid
        The whole grid.
    slab
        The slab.
    """
    with np.load(path) as content:
        field = Field(*[content[_name(slab, name)] for name in Field._fields])
    # The numbers of vertices have one more layer along each axis than the cells.
    layers = [n + 2 * LAYERS + 1 for n in grid.shape[1:]]
    labels = field.labels.reshape(-1, *layers)[:-1, :-1, :-1]
    return SpatialDecision(labels, field, _NO_CONTACTS, n_overruled=0)


def _name(slab: Slab, name: str) -> str:
    return f"{slab.number:04d}_{name}"
