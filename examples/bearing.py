"""A ball bearing without its balls' spurious contacts: ``python examples/bearing.py [FOLDER]``.

The balls miss the rings by a tenth of a millimetre, a fifth of a cell, and overlap the cage.  At a
threshold of 1/2 all eleven parts hang together.  What they should be is known beforehand: inner
ring, outer ring, and the cage with its balls, three components with a hole each.  Asked for them,
Tusqh keeps the cells of 1/2 and changes only those at the contacts; `changes.csv` lists them.
"""

import sys
from pathlib import Path

import tusqh

BEARING = Path(__file__).parent.parent / "data_sources/solids/bearings.stl"


def main(folder: Path) -> tuple[tusqh.Result, tusqh.Result]:
    """Mesh the bearing twice, at a threshold of 1/2 and with the topology that it should have."""
    # Parts overlap, so each sample of the winding number is clipped to [0, 1].
    plain = tusqh.mesh(BEARING, cells=48, rule="clamped", threshold=0.5)
    print(f"threshold 1/2: Betti numbers {plain.report.measured}\n")
    apart = tusqh.mesh(BEARING, cells=48, rule="clamped", betti=(3, 3, 0))
    print(apart.report)
    apart.save(folder)
    apart.write(folder / "bearing.inp")
    return plain, apart


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "bearing"))
