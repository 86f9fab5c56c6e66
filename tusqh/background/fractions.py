"""Volume fractions of the cells, edges and vertices of a background.

Every cell is split into the octants (in the plane quarters) of its reference cube, and samples in
each are averaged with the Jacobian as weight.  The fraction of a cell is the mean of its octants,
that of an edge the mean of the two octants at it of each hex around it, and that of a vertex the
mean of one octant of each cell around it, by volume.  On equal cubes these are the half-blocks of
a grid.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tusqh.background.background_mesh import BackgroundMesh
from tusqh.background.checks import require_overlap
from tusqh.background.node_values import NodeValues
from tusqh.background.scattered import ScatteredField
from tusqh.errors import ConfigError, SamplingError
from tusqh.geometry.image import Image
from tusqh.geometry.kinds import Geometry
from tusqh.grid import FloatArray, IndexArray
from tusqh.meshes.facets import HEX_EDGES
from tusqh.progress import Progress, log_progress
from tusqh.sampling.doubled_grid import RESOLUTION, Multiples
from tusqh.sampling.half_blocks import Tally
from tusqh.sampling.orient import orient
from tusqh.settings.sampling import Sampling

#: Samples that are taken at a time.
_AT_A_TIME = 2_000_000
#: Corners of the reference square and cube, in the order of a cell's corners.
_SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
_CUBE = np.array([[*xy, z] for z in (0, 1) for xy in _SQUARE.tolist()])


@dataclass(frozen=True)
class BackgroundFractions:
    """The volume fractions of the nodes of a background.

    Parameters
    ----------
    background
        The background.
    samples
        Samples along each side of a cell.
    values
        Fractions of cells, edges and vertices, as multiples of `RESOLUTION`.
    """

    background: BackgroundMesh
    samples: int
    values: NodeValues

    @property
    def cells(self) -> FloatArray:
        """Fractions of the cells, shape (m,)."""
        return np.asarray(self.values.cells * RESOLUTION)

    def volume(self) -> float:
        """Return the volume (2D: area) that the cell fractions add up to, in model units."""
        return float(self.cells @ self.background.volumes)


def sample_background(
    geometry: Geometry,
    background: BackgroundMesh,
    *,
    sampling: Sampling | None = None,
    progress: Progress = log_progress,
) -> BackgroundFractions:
    """Return the volume fractions of a geometry in the cells of a background.

    Parameters
    ----------
    geometry
        An outline or a soup.
    background
        The background.
    sampling
        How it is sampled; None: with the defaults.
    progress
        Shows how many samples have been taken.

    Raises
    ------
    ConfigError
        A setting of the sampling is not available with a background.
    SamplingError
        There is nothing inside.
    MeshError
        Geometry and background do not fit each other.

    Examples
    --------
    >>> from tusqh.background.makers import make_box
    >>> from tusqh.geometry.outline import Outline
    >>> square = Outline.from_chains([np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])])
    >>> sample_background(square, make_box((0, 0), (4, 1), (2, 1))).cells.tolist()
    [0.5, 0.0]
    """
    sampling = sampling or Sampling()
    require_supported(geometry, sampling)
    require_overlap(background, geometry)
    assert not isinstance(geometry, Image)
    field = ScatteredField.of(orient(geometry, sampling.orientation).geometry)
    sums, weights = _integrate(field, background, sampling, 1, progress)
    tally = Tally(1.0)
    tally.add(sums / weights)
    sign = tally.sign(sampling.orientation)
    if sampling.rule == "clamped":  # Clipping needs the sign.
        sums, weights = _integrate(field, background, sampling, sign, progress)
    else:
        sums *= sign
        if sampling.domain == "outside":
            sums = weights - sums
    values = combine_octants(background, sums, weights)
    if not tally.is_nonzero or not (values.cells > 0).any():
        raise SamplingError(
            f"no cell of the background has a positive fraction of the {sampling.domain} of the "
            "geometry",
            where=geometry.name,
            expected="some material in the background",
            remedy="use the other `domain`, `orientation: auto`, or another background",
        )
    return BackgroundFractions(background, sampling.samples, values)


def require_supported(geometry: Geometry, sampling: Sampling) -> None:
    """Raise an error for what cannot be sampled in a background.

    Parameters
    ----------
    geometry
        The geometry.
    sampling
        How it is sampled.

    Raises
    ------
    ConfigError
        It is an image, its inside is an envelope or a shell, libigl samples it, or the number of
        samples is odd.
    """
    wrong = ""
    if isinstance(geometry, Image):
        wrong = "an image of voxels"
    elif sampling.inside != "winding":
        wrong = f"`inside: {sampling.inside}`"
    elif sampling.sampler != "crossings":
        wrong = f"`sampler: {sampling.sampler}`"
    elif sampling.samples < 2 or sampling.samples % 2:
        wrong = f"{sampling.samples} samples along a cell"
    if wrong:
        raise ConfigError(
            f"{wrong} with a background mesh",
            where=geometry.name,
            expected="an outline or a surface, `inside: winding`, `sampler: crossings`, and an "
            "even number of samples",
            remedy="leave out the background mesh, or the other setting",
        )


def combine_octants(
    background: BackgroundMesh, sums: FloatArray, weights: FloatArray
) -> NodeValues:
    """Return the fractions of all nodes, rounded to `RESOLUTION`.

    Parameters
    ----------
    background
        The background.
    sums, weights
        Integral over, and volume of, the octant at every corner, shape (m, 2**dim).
    """
    found = [_round(sums.sum(axis=1), weights.sum(axis=1)), np.zeros(0, dtype=np.int32)]
    if background.dim == 3:
        # The two octants at every edge.
        pairs = [octants[:, HEX_EDGES].sum(axis=2) for octants in (sums, weights)]
        found[1] = _average(background.edge_of, background.n_edges, *pairs)
    vertices = _average(background.cells, background.n_points, sums, weights)
    return NodeValues(found[0], found[1], vertices)


def _average(parts: IndexArray, n: int, sums: FloatArray, weights: FloatArray) -> Multiples:
    """Return the mean at every part of the cells."""
    totals = [np.bincount(parts.ravel(), octants.ravel(), n) for octants in (sums, weights)]
    return _round(np.asarray(totals[0], np.float64), np.asarray(totals[1], np.float64))


def _round(sums: FloatArray, weights: FloatArray) -> Multiples:
    return np.rint(sums / weights / RESOLUTION).astype(np.int32)


def _integrate(
    field: ScatteredField,
    background: BackgroundMesh,
    sampling: Sampling,
    sign: int,
    progress: Progress,
) -> tuple[FloatArray, FloatArray]:
    """Return the integral of the winding number over every octant, and its volume."""
    dim, m = background.dim, background.n_cells
    corners = _SQUARE if dim == 2 else _CUBE
    along = (np.arange(sampling.samples) + 0.5) / sampling.samples
    reference = np.stack(np.meshgrid(*[along] * dim, indexing="ij"), axis=-1).reshape(-1, dim)
    octant = ((reference[:, None] > 0.5) == corners).all(axis=2).argmax(axis=1)
    share = np.where(corners == 1, reference[:, None], 1 - reference[:, None])
    shape = share.prod(axis=2)
    slope = np.stack(
        [
            np.where(corners[:, k] == 1, 1.0, -1.0) * np.delete(share, k, axis=2).prod(axis=2)
            for k in range(dim)
        ],
        axis=2,
    )
    sums, weights = np.zeros((m, 2**dim)), np.zeros((m, 2**dim))
    report = progress("sampling")
    per_batch = max(1, _AT_A_TIME // len(reference))
    is_in = np.eye(2**dim)[octant]
    for begin in range(0, m, per_batch):
        cells = background.points[background.cells[begin : begin + per_batch]]
        places = np.einsum("sc,mcd->msd", shape, cells)
        jacobian = np.linalg.det(np.einsum("sck,mcd->mskd", slope, cells))
        winding = field.at(places.reshape(-1, dim)).reshape(jacobian.shape)
        if sampling.rule == "clamped":
            winding = sign * winding
            winding = np.clip(1 - winding if sampling.domain == "outside" else winding, 0, 1)
        sums[begin : begin + per_batch] = (winding * jacobian) @ is_in
        weights[begin : begin + per_batch] = jacobian @ is_in
        report(min(begin + per_batch, m) * len(reference), m * len(reference))
    return sums, weights
