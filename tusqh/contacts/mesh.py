"""Make one mesh of several materials, each a manifold with predicted Betti numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tusqh.contacts.decide import decide_contacts, emit_decision
from tusqh.contacts.material_fractions import FULL, MaterialFractions
from tusqh.contacts.predict import predict_betti, predict_solid
from tusqh.contacts.voxel_fractions import fractions_of_labels
from tusqh.errors import TopologyError
from tusqh.grid import IntArray
from tusqh.meshes.formats import Export, write_mesh
from tusqh.meshes.interfaces import Interface, find_interfaces
from tusqh.meshes.measure_regions import RegionMeasurement, measure_regions
from tusqh.meshes.regions import Regions
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.topology.betti_numbers import BettiNumbers

__all__ = ["MaterialMesh", "mesh_materials"]


@dataclass(frozen=True)
class MaterialMesh:
    """A conforming mesh of several materials.

    Parameters
    ----------
    mesh
        All elements.
    names
        The materials; the last one is the void.
    material
        Number of the material of every element, shape (m,).
    predicted
        Betti numbers of every material including the void, predicted before meshing; the void
        fills the outside of the grid.
    predicted_solid
        Betti numbers of all materials together without the void.
    n_contacts
        Number of pinched vertices and edges, each of which has one vote.
    n_overruled
        Number of votes that the mesh does not follow.
    """

    mesh: VolumeMesh
    names: tuple[str, ...]
    material: IntArray
    predicted: dict[str, BettiNumbers]
    predicted_solid: BettiNumbers
    n_contacts: int
    n_overruled: int

    def part(self, name: str) -> VolumeMesh:
        """Return the mesh of one material alone, with its own points.

        Parameters
        ----------
        name
            The material.
        """
        chosen = np.flatnonzero(self.material == self.names.index(name))
        return self.mesh.take(chosen, name=name)

    @property
    def regions(self) -> Regions:
        """The material of every element, with the names."""
        return Regions(self.names, self.material)

    def write(self, path: Path, export: Export | None = None) -> None:
        """Write all elements with their materials, see `tusqh.meshes.formats.write_mesh`.

        Parameters
        ----------
        path
            File to write; its suffix names the format.
        export
            Elements and names of sets.
        """
        write_mesh(path, self.mesh, self.regions, export)

    @cached_property
    def measured(self) -> dict[str, RegionMeasurement]:
        """The measurement of every material that has elements."""
        regions = measure_regions(self.mesh, self.material, len(self.names))
        return {n: found for n, found in zip(self.names, regions, strict=True) if found.n_cells}

    @cached_property
    def measured_solid(self) -> RegionMeasurement:
        """The measurement of all materials together without the void."""
        solid = np.flatnonzero(self.material != len(self.names) - 1)
        if len(solid) == len(self.material):
            return RegionMeasurement.of(self.mesh.measurement)
        return RegionMeasurement.of(self.mesh.take(solid, name=self.mesh.name).measurement)

    @property
    def is_as_predicted(self) -> bool:
        """Whether every material and the solid are sound and have the predicted Betti numbers."""
        solid = self.measured_solid
        return (
            self.mesh.measurement.is_sound
            and solid.n_non_manifold == 0
            and solid.has_topology(self.predicted_solid)
            and all(
                found.n_non_manifold == 0 and found.has_topology(self.predicted[name])
                for name, found in self.measured.items()
            )
        )

    @cached_property
    def interfaces(self) -> dict[tuple[str, str], Interface]:
        """The facets between every two materials, including the void."""
        return find_interfaces(self.mesh, self.material, self.names)


def mesh_materials(
    source: MaterialFractions | NDArray[np.integer],
    *,
    thresholds: Mapping[str, float] | None = None,
    labels: NDArray[np.int32] | None = None,
    with_void: bool = False,
    name: str = "mesh",
) -> MaterialMesh:
    """Return the mesh of several materials; a vote decides every contact.

    A cell takes the material with the largest ratio of fraction to threshold, and so does every
    pinched edge and vertex, among the materials of its cells.

    Parameters
    ----------
    source
        Fractions of all materials on a background grid, or an image of labels whose voxels are the
        cells; `tusqh.contacts.fractions_of_labels` has further options.
    thresholds
        Thresholds of materials, above 0 and at most 1; 1 for the others.  For one material, the
        thresholds t and 1 - t of material and void keep the cells with at least the fraction t.
    labels
        Material of every cell, shape n; None: the one with the largest ratio.
    with_void
        Whether to mesh the void too, in the grid and in one layer of cells around it.
    name
        Name of the mesh in messages.

    Raises
    ------
    TopologyError
        A threshold is out of range or does not belong to a material.
    SamplingError
        The image is not an image of labels.

    Examples
    --------
    >>> found = mesh_materials(np.array([[1, 2], [2, 1]]))
    >>> {name: str(betti) for name, betti in found.predicted.items()}
    {'1': '(1, 0, 0)', '2': '(2, 0, 0)', 'void': '(1, 1, 0)'}
    >>> found.is_as_predicted, found.mesh.n_cells
    (True, 24)
    """
    fractions = source if isinstance(source, MaterialFractions) else fractions_of_labels(source)
    t = round_thresholds(fractions.names, dict(thresholds or {}))
    labels = fractions.label_cells(t) if labels is None else labels
    decision = decide_contacts(fractions, labels, t)
    left_out = None if with_void else fractions.void
    mesh, material = emit_decision(decision, fractions.grid, name, left_out=left_out)
    padded = np.ascontiguousarray(decision.labels, dtype=np.int32)
    contacts = decision.contacts
    predicted = predict_betti(padded, contacts, len(fractions.names))
    return MaterialMesh(
        mesh=mesh,
        names=fractions.names,
        material=material,
        predicted=dict(zip(fractions.names, predicted, strict=True)),
        predicted_solid=predict_solid(padded, contacts, fractions.void),
        n_contacts=len(contacts),
        n_overruled=decision.n_overruled,
    )


def round_thresholds(names: Sequence[str], thresholds: Mapping[str, float]) -> IntArray:
    """Return the threshold of every material in multiples of 2**-20, rounded up.

    Parameters
    ----------
    names
        The materials; the last one is the void, whose threshold is rounded down.
    thresholds
        Thresholds of materials by name; 1 for the others.

    Raises
    ------
    TopologyError
        A threshold is out of range or does not belong to a material.
    """
    for name, value in thresholds.items():
        if name not in names or not 0 <= value <= 1 or (value == 0 and name != names[-1]):
            raise TopologyError(
                f"the threshold {value!r} of {name!r}",
                where="thresholds of materials",
                expected=f"numbers above 0 and at most 1, of {', '.join(names)}",
                remedy="correct the name or the number",
            )
    wanted = np.array([thresholds.get(name, 1.0) for name in names])
    rounded: IntArray = np.ceil(wanted * FULL).astype(np.int64)
    # Round the void's threshold down, so that with t and 1 - t both conditions are equivalent.
    rounded[-1] = int(np.floor(wanted[-1] * FULL))
    return rounded
