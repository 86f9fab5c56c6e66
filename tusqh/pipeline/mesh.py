"""Run all stages in one call, from a geometry to a judged mesh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from tusqh.errors import ConfigError
from tusqh.pipeline.materials.mesh import has_several_materials, mesh_several
from tusqh.pipeline.materials.result import MaterialsResult
from tusqh.pipeline.result import Result
from tusqh.pipeline.slabs.mesh import SlabResult, mesh_in_slabs
from tusqh.pipeline.stages import run_stages
from tusqh.progress import Progress, log_progress
from tusqh.settings.arguments import arguments_of, explains_unknown_arguments, from_arguments
from tusqh.settings.goal import Base, Scope
from tusqh.settings.grid import Align, Place
from tusqh.settings.materials import Materials
from tusqh.settings.model import Settings
from tusqh.settings.policy import BridgeMode
from tusqh.settings.sampling import Domain, Inside, Orientation, Rule, Sampler

__all__ = ["mesh"]

#: Type of `betti`: up to three numbers, lists of numbers, ranges, or None for any number.
Betti = Sequence[int | Sequence[int] | Mapping[str, int] | None]


@explains_unknown_arguments
def mesh(
    source: Any,
    *,
    cells: int | Sequence[int] | None = None,
    cell_size: float | Sequence[float] | None = None,
    placement: Place = "auto",
    offset: Sequence[float] | None = None,
    snap: bool = False,
    rotate: Sequence[float] | None = None,
    align: Align | None = None,
    betti: Betti | None = None,
    threshold: float | None = None,
    persistence: float | None = None,
    volume: Literal["match"] | None = None,
    scope: Scope | None = None,
    features: Sequence[Mapping[str, Any]] | None = None,
    base: Base = 0.5,
    window: Sequence[Sequence[float]] | None = None,
    domain: Domain = "inside",
    samples: int = 4,
    inside: Inside = "winding",
    seal: float | str | None = None,
    thickness: float | str | None = None,
    rule: Rule = "average",
    orientation: Orientation = "auto",
    sampler: Sampler = "crossings",
    tolerance: float = 1e-6,
    bridges: BridgeMode | None = None,
    components: Mapping[str, Any] | None = None,
    holes: Mapping[str, Any] | None = None,
    voids: Mapping[str, Any] | None = None,
    unit: str | None = None,
    scale: float = 1.0,
    convert_to: str | None = None,
    crs: str | None = None,
    image: Mapping[str, float] | None = None,
    fit: bool = False,
    coarsen: Literal["interior", "conforming"] | None = None,
    volume_tolerance: float = 0.05,
    checks: Literal["all"] | None = None,
    slabs: int | Literal["auto"] | None = None,
    output: Path | str | None = None,
    materials: Materials | None = None,
    rest: str | None = None,
    name: str | None = None,
    progress: Progress = log_progress,
) -> Result | MaterialsResult | SlabResult:
    """Return the quad or hex mesh of a dirty geometry, with the requested topology.

    Parameters
    ----------
    source
        A path, a mesh of trimesh or pyvista, arrays (points, triangles), or an array of voxels,
        see `tusqh.pipeline.ingest.ingest`.  A list of these, or a mapping from names to them, is
        meshed as several materials; where they overlap, the earlier one has priority.
    cells
        Cells along the longest side (64 by default), or one number for each axis.
    cell_size
        Edge length of a cell, in units of the geometry, instead of `cells`; or one for each axis.
    placement
        ``"auto"`` moves the grid by a fraction of a cell if the volume is more than 1 % off;
        ``"corner"`` lays it on the box.
    offset
        Instead of `placement`: how far the grid is moved along each axis, in cells.
    snap
        Instead of `placement`: lay planes of the grid on plane faces of the geometry, with cells
        of another size where that is necessary.
    rotate
        How the axes of the grid are turned: one angle in degrees in the plane, in space three about
        x, then y, then z; or a rotation matrix, row by row, whose rows are these axes.
    align
        Turn the axes of the grid to the most area of plane ``"faces"``, or to the ``"principal"``
        axes of the surface.
    betti
        Requested numbers of components, holes and voids, such as ``(1, 0, 0)``.  Each may be a
        number, a list, ``{"min": 1, "max": 3}``, or None for any number.
    threshold
        Alternatively, keep cells with at least this volume fraction; 0.5 if nothing is requested.
    persistence
        Alternatively, keep only features with at least this persistence.
    volume
        ``"match"`` chooses the threshold whose mesh best matches the volume of the geometry; with
        `betti` or `persistence`, among the thresholds that meet that request.
    scope
        With `betti` or `persistence`: ``"local"``, the default, keeps the cells of the threshold
        `base` and adds or leaves out only those that the topology needs; ``"global"`` keeps the
        cells of the one threshold that gives the topology, as in the paper.
    features
        Single features of the persistence diagram that are opened, cut or filled, such as
        ``[{"near": (0, 0, 1), "class": "hole", "do": "fill"}, {"row": 3, "do": "cut"}]``; of
        several materials each names its own, as in ``{"material": "ring", "row": 3, ...}``.
    base
        With the local scope: that threshold, or ``"match"`` for the one whose cells have the
        volume of the geometry.
    window
        Lowest and highest corner of the box to mesh in; the bounding box by default.
    domain
        ``"inside"`` meshes the interior of the geometry, ``"outside"`` the rest of the window.
    samples
        Number of samples along each side of a cell, even.
    inside
        ``"winding"``: inside is where the surface winds; ``"envelope"``: what a ball cannot reach
        from outside; ``"shell"``: what is near the surface; ``"union"``: winding and shell.
    seal
        Diameter of the ball of the envelope, a number in model units or text such as ``"2 mm"`` or
        ``"0.5 cells"``, which is the default.
    thickness
        Thickness of the shell, likewise; one cell by default.
    rule
        ``"clamped"`` clips samples to [0, 1], which is right for overlapping parts.
    orientation
        ``"auto"`` turns geometries that are inside out, ``"as-is"`` none, ``"flip"`` all.
    sampler
        ``"crossings"`` counts crossings on the lattice, ``"libigl"`` calls libigl at every sample.
    tolerance
        Largest error of a fraction before it is rounded, for the sampler ``"crossings"``.
    bridges
        Which components to join along interior edges: ``"forest"``, ``"all"`` or ``"none"``; by
        default a forest in 2D and none in 3D.
    components, holes, voids
        Criteria that these must meet to stay, such as ``{"min_cells": 4}``, see
        `tusqh.settings.policy.Criteria`.
    unit
        Unit of length of the numbers in the source, such as ``"mm"``; a file that states another
        one is rejected.
    scale
        Factor by which all lengths in the source are multiplied.
    convert_to
        Unit of length into which the geometry is converted, and in which the mesh is.
    crs
        Coordinate system into which a map is projected: ``"utm"``, a code such as
        ``"EPSG:32618"``, or ``"none"`` if its coordinates are lengths.
    image
        For voxels: ``{"voxel_size": 0.1, "empty": 0, "full": 255}``, see
        `tusqh.settings.voxels.Voxels`.
    fit
        Move the boundary onto the geometry; `Result.staircase` is the mesh before.
    coarsen
        ``"interior"`` also makes `Result.coarse`, a mesh with larger elements away from the
        boundary, and hanging vertices between elements of different size; with ``"conforming"``
        it has none.
    volume_tolerance
        Largest relative difference between the volumes of the mesh and of the geometry that causes
        no warning (with `volume`, no error).
    checks
        ``"all"`` lets VTK, MFEM and pymeshlab check meshes of more than 50,000 elements too.
    slabs
        Number of slabs in which a large mesh is made, with less memory; ``"auto"`` takes the
        smallest number that fits.
        The mesh is written to `output`, and the result is a
        `tusqh.pipeline.slabs.mesh.SlabResult`.
    output
        With `slabs`: the file to write, pieces with a ``.pvtu`` file or one ``.vtu`` file.
    materials
        Mesh several materials: ``"parts"`` for the parts of the geometry, or names of labels or
        wishes for materials, such as ``{1: "bone", 2: "marrow"}`` and
        ``{"ring": 0.4, "ball": (1, 0, 0)}``, see `tusqh.settings.materials.to_materials`.
    rest
        Name of the material that fills what the others leave of the grid or window.
    name
        Name of the model in files and messages; by default the name of the file.
    progress
        Shows the progress of long steps; by default as lines in the log ``tusqh``.

    Returns
    -------
    result
        The result, with `mesh`, `diagram`, `curves`, `report` and all intermediate results; of
        several materials with `mesh`, `materials`, `pairs` and `part`; in slabs with `paths`,
        `measurement` and `report`.

    Raises
    ------
    ConfigError
        An argument is out of range, or two of them contradict each other.
    GeometryError
        The source cannot be read or is empty.
    SamplingError
        Grid and geometry do not fit each other, or there is nothing inside.
    TopologyError
        No threshold meets the request; the message lists the reachable Betti numbers.

    Examples
    --------
    This square frame has a gap in its border:

    >>> import tusqh
    >>> points = [[0, 0], [3, 0], [3, 3], [0, 3], [1, 1], [1, 2], [2, 2], [2, 1]]
    >>> lines = [[0, 1], [1, 2], [2, 3], [4, 5], [5, 6], [6, 7], [7, 4]]
    >>> result = tusqh.mesh((points, lines), cells=12, betti=(1, 1), name="frame")
    >>> print(result.report.measured, result.report.is_suitable, result.mesh.cells.shape[1])
    (1, 1, 0) True 4
    """
    given = locals()
    settings = from_arguments(Settings, {key: given[key] for key in arguments_of(Settings)})
    if settings.memory.slabs is not None or output is not None:
        path = _require_slabs(settings, output, is_several=has_several_materials(source, materials))
        return mesh_in_slabs(source, settings, [path], name=name, progress=progress)
    if has_several_materials(source, materials):
        wishes = "parts" if materials is None else materials
        return mesh_several(source, settings, materials=wishes, rest=rest, name=name)
    return run_stages(source, settings, name=name, progress=progress)


def _require_slabs(settings: Settings, output: Path | str | None, *, is_several: bool) -> Path:
    """Return the file of a mesh in slabs, or raise an error if arguments contradict each other."""
    if settings.memory.slabs is None or output is None or is_several:
        given = "materials" if is_several else "output" if output is not None else "slabs"
        raise ConfigError(
            f"`{given}` with `slabs`" if is_several else f"`{given}` alone",
            where="tusqh.mesh",
            expected="`slabs` and `output` together, for a mesh of one material",
            remedy="give both; the result of a mesh in one piece has the method `write`",
        )
    return Path(output)
