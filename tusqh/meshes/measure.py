"""The measurement of a mesh, on which every table, certificate and verdict is based."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

from tusqh.errors import MeshError
from tusqh.meshes.betti import betti_by_boundary, betti_by_euler
from tusqh.meshes.checks import CONFORMITY, Check, check_mesh
from tusqh.meshes.element_mesh import ElementMesh
from tusqh.meshes.jacobians import enclosed_volume
from tusqh.meshes.manifold import find_non_manifold_points
from tusqh.topology.betti_numbers import BettiNumbers


class Measured(Protocol):
    """What certificates and verdicts need of a measurement, of a whole mesh or of its pieces."""

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks of indices, coordinates, conformity, boundary and orientation."""

    @property
    def failed(self) -> tuple[Check, ...]:
        """The checks that the mesh does not pass."""

    @property
    def is_sound(self) -> bool:
        """Whether the mesh passes every check."""

    @property
    def by_euler(self) -> BettiNumbers:
        """Betti numbers by components and Euler characteristic."""

    @property
    def by_boundary(self) -> BettiNumbers:
        """Betti numbers by components and boundary."""

    def has_topology(self, predicted: BettiNumbers) -> bool:
        """Return whether both methods measure the predicted Betti numbers.

        Parameters
        ----------
        predicted
            The Betti numbers predicted before meshing.
        """


@dataclass(frozen=True)
class Measurement:
    """Properties of a mesh, measured from its points and elements alone.

    Each property is computed once, when it is first needed.

    Parameters
    ----------
    mesh
        The mesh.
    """

    mesh: ElementMesh

    @cached_property
    def checks(self) -> tuple[Check, ...]:
        """The checks of `tusqh.meshes.checks.check_mesh`."""
        return tuple(check_mesh(self.mesh))

    @cached_property
    def by_euler(self) -> BettiNumbers:
        """Betti numbers by components and Euler characteristic."""
        return betti_by_euler(self.mesh)

    @cached_property
    def by_boundary(self) -> BettiNumbers:
        """Betti numbers by components and boundary."""
        return betti_by_boundary(self.mesh)

    @property
    def failed(self) -> tuple[Check, ...]:
        """The checks that the mesh does not pass."""
        return tuple(check for check in self.checks if not check.holds)

    @property
    def is_sound(self) -> bool:
        """Whether the mesh passes every check: it is conforming, manifold and valid."""
        return not self.failed

    @property
    def is_conforming(self) -> bool:
        """Whether elements that meet share whole facets, edges or points."""
        return not any(check.id in CONFORMITY for check in self.failed)

    @property
    def is_manifold(self) -> bool:
        """Whether the boundary is a manifold; False if an earlier check failed."""
        return any(check.id == "non_manifold_points" and check.holds for check in self.checks)

    @cached_property
    def n_non_manifold(self) -> int:
        """Number of boundary points at which the boundary is not a manifold."""
        return len(find_non_manifold_points(self.mesh.facets))

    @cached_property
    def smallest_scaled_jacobian(self) -> float:
        """The smallest scaled Jacobian of all corners; 1 for a mesh without elements."""
        return float(self.mesh.jacobians.scaled.min(initial=1.0))

    @cached_property
    def volume(self) -> float:
        """Area or volume of all elements, model units**dim."""
        return float(self.mesh.volumes.sum())

    @cached_property
    def enclosed(self) -> float:
        """Volume within the boundary of a mesh of hexes, model units**3."""
        return enclosed_volume(self.mesh.points, self.mesh.facets.boundary)

    def has_topology(self, predicted: BettiNumbers) -> bool:
        """Return whether both methods measure the predicted Betti numbers.

        Parameters
        ----------
        predicted
            The Betti numbers predicted before meshing.
        """
        return self.by_euler == self.by_boundary == predicted

    def require_sound(self) -> None:
        """Raise an error that names the model and every check that it fails.

        Raises
        ------
        MeshError
            A check fails.
        """
        if self.failed:
            raise MeshError(
                "; ".join(f"{check.name}: {check.found}" for check in self.failed),
                where=self.mesh.name,
                expected="a conforming, manifold mesh of valid elements",
                remedy="make the mesh with `tusqh`, or repair it in the tool that wrote it",
            )


def measure(mesh: ElementMesh) -> Measurement:
    """Return the measurement of a mesh.

    `tusqh.meshes.volume_mesh.VolumeMesh.measurement` is the same measurement, cached.

    Parameters
    ----------
    mesh
        The mesh.

    Examples
    --------
    >>> import numpy as np
    >>> from tusqh.meshes.volume_mesh import VolumeMesh
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> measured = measure(VolumeMesh.from_arrays(square, [[0, 1, 2, 3]]))
    >>> measured.is_sound, str(measured.by_euler), measured.volume
    (True, '(1, 0, 0)', 1.0)
    """
    return Measurement(mesh)
