"""Make the analytic solids and the bearing: ``python data_sources/solids/derive.py``.

The bearing follows the outer dimensions of a deep groove ball bearing 608 (ISO 15: bore 8 mm,
outside diameter 22 mm, width 7 mm).  Its parts are separate closed surfaces: the balls overlap the
cage and miss the rings by a tenth of a millimetre, as in unrepaired assemblies.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import trimesh

FOLDER = Path(__file__).parent


def ring(
    bore: float, outside: float, width: float, groove: float, *, outer: bool
) -> trimesh.Trimesh:
    """Return a ring, in mm, with a groove of a given radius around the pitch circle of 15 mm."""
    half = width / 2
    inner, rim = bore / 2, outside / 2
    angles = np.linspace(-0.7, 0.7, 15)
    if outer:
        arc = np.column_stack([7.5 + groove * np.cos(angles), groove * np.sin(angles)])
        profile = [[rim, -half], [rim, half], [inner, half], *arc[::-1], [inner, -half]]
    else:
        arc = np.column_stack([7.5 - groove * np.cos(angles), groove * np.sin(angles)])
        profile = [[inner, -half], [rim, -half], *arc, [rim, half], [inner, half]]
    profile = [*profile, profile[0]]
    solid = trimesh.creation.revolve(np.array(profile, dtype=float), sections=96)
    return solid if solid.volume > 0 else trimesh.Trimesh(solid.vertices, solid.faces[:, ::-1])


def bearing() -> list[trimesh.Trimesh]:
    """Return two rings, seven balls and the two halves of a cage."""
    parts = [
        ring(8.0, 11.4, 7.0, 2.0, outer=False),
        ring(18.6, 22.0, 7.0, 2.0, outer=True),
    ]
    for k in range(7):
        ball = trimesh.creation.icosphere(subdivisions=3, radius=1.9)
        angle = 2 * np.pi * k / 7
        ball.apply_translation([7.5 * np.cos(angle), 7.5 * np.sin(angle), 0.0])
        parts.append(ball)
    for z in (-0.35, 0.35):
        half = trimesh.creation.annulus(r_min=7.0, r_max=8.0, height=0.9, sections=96)
        half.apply_translation([0.0, 0.0, z])
        parts.append(half)
    return parts


def write(name: str, parts: list[trimesh.Trimesh]) -> None:
    """Write parts into one binary STL, one after the other."""
    whole = trimesh.util.concatenate(parts)
    (FOLDER / f"{name}.stl").write_bytes(whole.export(file_type="stl"))


def main() -> None:
    """Write all solids."""
    outer, inner = (trimesh.creation.icosphere(subdivisions=4, radius=r) for r in (10.0, 6.0))
    core = trimesh.creation.icosphere(subdivisions=3, radius=3.0)
    cavity = trimesh.Trimesh(inner.vertices, inner.faces[:, ::-1])
    write("torus", [trimesh.creation.torus(10.0, 3.0, major_sections=96, minor_sections=48)])
    write("hollow_sphere", [outer, cavity])
    write("nested_spheres", [outer, cavity, core])
    write("bearings", bearing())
    balls = [trimesh.creation.icosphere(subdivisions=3, radius=r) for r in (3.0, 6.0, 10.0)]
    write("shells", balls)


if __name__ == "__main__":
    main()
