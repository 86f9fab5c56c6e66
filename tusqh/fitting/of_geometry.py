"""The target of any geometry."""

from __future__ import annotations

from tusqh.fitting.made_target import target_of_made
from tusqh.fitting.planar.outline_target import target_of_outline
from tusqh.fitting.target import Target
from tusqh.geometry.image import Image
from tusqh.geometry.kinds import Geometry
from tusqh.geometry.outline import Outline
from tusqh.grid import BoolArray
from tusqh.sampling.fractions import VolumeFractions
from tusqh.sampling.lattice import Box
from tusqh.settings.sampling import Sampling


def target_of(
    geometry: Geometry,
    fractions: VolumeFractions,
    *,
    sampling: Sampling | None = None,
    sides: Box | None = None,
    changed: BoolArray | None = None,
) -> Target:
    """Return where the boundary of a mesh of a geometry should lie.

    Parameters
    ----------
    geometry
        An outline, a soup or an image.
    fractions
        The fractions from which the mesh was made.
    sampling
        How they were sampled; None: with the defaults.
    sides
        Box whose sides cut the material, in model units, such as the window; None: the sides of the
        grid in 2D, no sides in 3D.
    changed
        Cells that were added or removed on purpose, shape n.
    """
    sampling = sampling or Sampling()
    if sampling.inside != "winding" and not isinstance(geometry, Image):
        return target_of_made(geometry, fractions, sampling, sides=sides, changed=changed)
    if isinstance(geometry, Outline):
        return target_of_outline(geometry, fractions, sides=sides, changed=changed)
    return Target.of(
        geometry, fractions, orientation=sampling.orientation, sides=sides, changed=changed
    )
