"""Read the triangles of a glTF file (.gltf, .glb), with each mesh placed as in the scene."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from tusqh.extras import require
from tusqh.geometry.remark import Remark
from tusqh.geometry.soup import Part, Soup
from tusqh.grid import FloatArray, IntArray
from tusqh.readers.gltf_file import GltfFile
from tusqh.readers.polygon_faces import cut_polygons, cut_strips
from tusqh.readers.reading import Reading

_INSTANCES, _DRACO = "EXT_mesh_gpu_instancing", "KHR_draco_mesh_compression"
_SUPPORTED = {_INSTANCES, "KHR_mesh_quantization", _DRACO}
#: Extensions with these prefixes affect appearance, not geometry.
_APPEARANCE = ("KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "KHR_xmp")
_TRIANGLES, _STRIP, _FAN = 4, 5, 6


def read(path: Path) -> Reading:
    """Read every mesh of the scene as a part of the soup, once for each of its instances.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    Reading
        The geometry, with remarks on points, lines, deformations and other scenes.

    Raises
    ------
    GeometryError
        The file is cut off, needs an unsupported extension, or contradicts its stated extremes; or
        the soup is empty, without extent or not finite.
    """
    return read_scene(GltfFile(path), name=path.name)


def read_scene(file: GltfFile, *, name: str) -> Reading:
    """Read every mesh of the scene of a glTF document.

    Parameters
    ----------
    file
        The document.
    name
        Name of the geometry.

    Returns
    -------
    Reading
        The geometry.

    Raises
    ------
    GeometryError
        See `read`.
    """
    for extension in file.document.get("extensionsRequired", ()):
        if extension not in _SUPPORTED and not extension.startswith(_APPEARANCE):
            raise file.fault(
                f"the extension {extension} is required and not supported",
                remedy="export the file without it (without compression)",
            )
    left_out: Counter[str] = Counter()
    parts: list[Part] = []
    names: list[str] = []
    for node, matrix in _placed_nodes(file, left_out):
        if "mesh" not in node:
            continue
        if "skin" in node:
            left_out["skins, so that meshes are in their rest position"] += 1
        mesh = file.item("meshes", node["mesh"])
        points, triangles = _mesh(file, mesh, left_out)
        for instance in _instances(file, node):
            place = matrix @ instance
            is_mirrored = np.linalg.det(place[:3, :3]) < 0
            moved = points @ place[:3, :3].T + place[:3, 3]
            parts.append((moved, triangles[:, ::-1] if is_mirrored else triangles))
            names.append(str(node.get("name") or mesh.get("name") or ""))
    n_scenes = len(file.document.get("scenes", ()))
    left_out["scenes beside the first one"] += max(n_scenes - 1, 0)
    remarks = [Remark("left out", what, n) for what, n in left_out.items() if n]
    soup = Soup.from_parts(parts, name=name, part_names=names)
    return Reading(soup, tuple(remarks))


def _placed_nodes(
    file: GltfFile, left_out: Counter[str]
) -> Iterator[tuple[dict[str, Any], FloatArray]]:
    """Yield the nodes of the scene with their transforms."""
    nodes = file.document.get("nodes", [])
    if file.document.get("scenes"):
        roots = file.item("scenes", file.document.get("scene", 0)).get("nodes", [])
    else:
        children = {child for node in nodes for child in node.get("children", ())}
        roots = [k for k in range(len(nodes)) if k not in children]
    stack = [(number, np.eye(4)) for number in reversed(roots)]
    seen: set[int] = set()
    while stack:
        number, above = stack.pop()
        node = file.item("nodes", number)
        if number in seen:
            raise file.fault(f"node {number} is placed twice")
        seen.add(number)
        matrix = above @ _matrix(node)
        yield node, matrix
        stack += [(child, matrix) for child in reversed(node.get("children", []))]
    left_out["meshes outside the scene"] += sum(
        "mesh" in node for k, node in enumerate(nodes) if k not in seen
    )


def _matrix(node: dict[str, Any]) -> FloatArray:
    """Return the transform of a node relative to its parent."""
    if "matrix" in node:
        return np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
    return _composed(
        np.array(node.get("translation", (0, 0, 0)), dtype=np.float64),
        np.array(node.get("rotation", (0, 0, 0, 1)), dtype=np.float64),
        np.array(node.get("scale", (1, 1, 1)), dtype=np.float64),
    )


def _composed(translation: FloatArray, rotation: FloatArray, scale: FloatArray) -> FloatArray:
    """Return the matrix that scales, then rotates by a quaternion (x, y, z, w), then translates."""
    x, y, z, w = rotation / (np.linalg.norm(rotation) or 1.0)
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix = np.eye(4)
    matrix[:3, :3] = turn * scale
    matrix[:3, 3] = translation
    return matrix


def _instances(file: GltfFile, node: dict[str, Any]) -> list[FloatArray]:
    """Return the transforms of a node's instances, relative to the node."""
    extension = node.get("extensions", {}).get(_INSTANCES)
    if extension is None:
        return [np.eye(4)]
    found = {k: file.accessor(number) for k, number in extension["attributes"].items()}
    n = min((len(values) for values in found.values()), default=0)
    moves = found.get("TRANSLATION", np.zeros((n, 3)))
    turns = found.get("ROTATION", np.tile([0.0, 0.0, 0.0, 1.0], (n, 1)))
    scales = found.get("SCALE", np.ones((n, 3)))
    return [_composed(moves[k], turns[k], scales[k]) for k in range(n)]


def _mesh(file: GltfFile, mesh: dict[str, Any], left_out: Counter[str]) -> Part:
    """Return the triangles of all primitives of a mesh."""
    all_points, all_triangles, n_points = [np.empty((0, 3))], [np.empty((0, 3), np.int64)], 0
    for primitive in mesh.get("primitives", ()):
        mode = primitive.get("mode", _TRIANGLES)
        if mode not in (_TRIANGLES, _STRIP, _FAN):
            left_out["sets of points or lines"] += 1
            continue
        left_out["shapes to blend a mesh with"] += len(primitive.get("targets", ()))
        found = _points_and_corners(file, primitive)
        if found is None:
            left_out["sets of triangles without positions"] += 1
            continue
        points, corners = found
        all_triangles.append(_triangles(file, corners, mode) + n_points)
        all_points.append(points)
        n_points += len(points)
    return np.concatenate(all_points), np.concatenate(all_triangles)


def _points_and_corners(
    file: GltfFile, primitive: dict[str, Any]
) -> tuple[FloatArray, IntArray] | None:
    """Return the points and the corners of a primitive, None if it has no positions."""
    position = primitive.get("attributes", {}).get("POSITION")
    packed = primitive.get("extensions", {}).get(_DRACO)
    has_bytes = position is not None and (
        {"bufferView", "sparse"} & file.item("accessors", position).keys()
    )
    if packed is not None and not has_bytes:
        return _unpack(file, packed)
    if position is None:
        return None
    points = file.accessor(position)
    if points.shape[1] != 3:
        raise file.fault(f"positions have {points.shape[1]} coordinates")
    corners = np.arange(len(points))
    if "indices" in primitive:
        corners = file.accessor(primitive["indices"])[:, 0].astype(np.int64)
    if corners.size and corners.max() >= len(points):
        raise file.fault(f"point {corners.max()} of {len(points)} is used")
    return points, corners


def _unpack(file: GltfFile, packed: dict[str, Any]) -> tuple[FloatArray, IntArray]:
    """Return the points and the corners of triangles that are compressed by Draco."""
    draco = require("DracoPy", extra="formats")
    content = file.bytes_of_view(packed["bufferView"])
    try:
        mesh = draco.decode(content)
        points = np.asarray(mesh.points, dtype=np.float64).reshape(-1, 3)
        corners = np.asarray(mesh.faces, dtype=np.int64).ravel()
    except (draco.FileTypeException, ValueError, AttributeError, TypeError) as error:
        raise file.fault(f"its compressed triangles cannot be read: {error}") from error
    if corners.size and not 0 <= corners.min() <= corners.max() < len(points):
        raise file.fault(f"a corner is out of the range 0 .. {len(points) - 1}")
    return points, corners


def _triangles(file: GltfFile, corners: IntArray, mode: int) -> IntArray:
    """Return the triangles of a list, a strip or a fan."""
    if mode == _TRIANGLES:
        if len(corners) % 3:
            raise file.fault(f"{len(corners)} corners are not a multiple of 3")
        return corners.reshape(-1, 3)
    count = np.array([len(corners)])
    return cut_strips(corners, count) if mode == _STRIP else cut_polygons(corners, count)[0]
