"""Furniture and a plane of sheets that are there twice, once in each direction."""

import numpy as np
import trimesh

#: Size and centre of the boxes of each model; the volume is that of their union.
BOXES = {
    "table": [((8, 5, 0.6), (0, 0, 4.0))]
    + [((0.7, 0.7, 4.0), (x, y, 2.0)) for x in (-3.4, 3.4) for y in (-1.9, 1.9)],
    "chair": [((4, 4, 0.7), (0, 0, 4.0)), ((4, 0.7, 4.4), (0, -1.65, 6.0))]
    + [((0.7, 0.7, 4.0), (x, y, 2.0)) for x in (-1.6, 1.6) for y in (-1.6, 1.6)],
    "plane": [
        *(((9, 1.4, 1.4), (0, 0, 0)), ((2, 9, 0.6), (0.5, 0, 0))),
        *(((1.2, 3, 0.6), (-4.0, 0, 0.3)), ((1.2, 0.6, 2.2), (-4.0, 0, 1.2))),
    ],
}


def doubled_sheets(name):
    """Return points, triangles and the exact volume of a model, whose boxes run into each other."""
    parts = [trimesh.creation.box(size) for size, _ in BOXES[name]]
    for part, (_, centre) in zip(parts, BOXES[name], strict=True):
        part.apply_translation(centre)
    both = trimesh.util.concatenate(parts)
    triangles = np.concatenate([both.faces, both.faces[:, ::-1]])
    return np.array(both.vertices), triangles, union_volume(BOXES[name])


def union_volume(boxes):
    """Return the volume of the union of boxes, from the cells between all of their planes."""
    low = np.array([np.subtract(centre, np.divide(size, 2)) for size, centre in boxes])
    high = np.array([np.add(centre, np.divide(size, 2)) for size, centre in boxes])
    planes = [np.unique(np.concatenate([low[:, k], high[:, k]])) for k in range(3)]
    middles = np.meshgrid(*[(p[1:] + p[:-1]) / 2 for p in planes], indexing="ij")
    sizes = np.meshgrid(*[np.diff(p) for p in planes], indexing="ij")
    places = np.stack(middles, axis=-1)[..., None, :]
    is_in = ((places > low) & (places < high)).all(axis=-1).any(axis=-1)
    return float((np.prod(sizes, axis=0) * is_in).sum())
