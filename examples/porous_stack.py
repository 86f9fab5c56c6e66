"""The pores of a stack of images: ``python examples/porous_stack.py [FOLDER]``.

The voxels are a corner of a reservoir model that comes with pyvista: river sand (porous, here grey
value 255) in tight rock (0).  They are written as a TIFF stack, as a scanner would, and meshed at
four voxels a cell: one body of sand through which something can flow, without holes or voids.
"""

import sys
from pathlib import Path

import numpy as np
import tifffile
from pyvista import examples

import tusqh

#: Voxels along each side of the corner that is meshed.
SIZE = 96


def write_stack(path: Path) -> None:
    """Write the corner of the reservoir as a TIFF stack: pages z, rows y, columns x."""
    reservoir = examples.load_channels()
    shape = np.subtract(reservoir.dimensions, 1)
    facies = reservoir.cell_data["facies"].reshape(shape, order="F")
    grey = np.where(facies[:SIZE, :SIZE, :SIZE] > 0, 255, 0).astype(np.uint8)
    path.parent.mkdir(parents=True, exist_ok=True)
    tifffile.imwrite(path, grey.transpose(), photometric="minisblack")


def main(folder: Path) -> tusqh.Result:
    """Mesh the body of sand that stays in one piece over the widest range of thresholds."""
    stack = folder / "sand.tif"
    write_stack(stack)
    result = tusqh.mesh(stack, cells=24, betti=(1, 0, 0), components={"keep": 1})
    print(result.report)
    print(
        f"\n{len(result.built.resolved.cells.features)} smaller bodies are listed in features.csv"
    )
    result.save(folder)
    return result


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "sand"))
