"""What a mesh in slabs cannot have, and how many slabs a grid needs."""

from __future__ import annotations

from tusqh.errors import ConfigError, SamplingError
from tusqh.geometry.kinds import Geometry
from tusqh.geometry.soup import Soup
from tusqh.grid import BackgroundGrid
from tusqh.grid.slabs import LEAST
from tusqh.machine import available_memory
from tusqh.sampling.memory import estimate_slabs
from tusqh.settings.model import Settings

#: Share of the free memory that `auto` takes.
_SHARE = 0.8


def require_possible(settings: Settings, geometry: Geometry, name: str) -> None:
    """Raise an error if a mesh in slabs cannot do what the settings ask for.

    Parameters
    ----------
    settings
        How the geometry is meshed.
    geometry
        The geometry.
    name
        The model, for the message.

    Raises
    ------
    ConfigError
        A setting is not available in slabs, or the geometry is not a surface in space.
    """
    wrong = list(settings.find_unavailable_in_slabs())
    if not isinstance(geometry, Soup):
        wrong.insert(0, "a geometry that is not a surface in space")
    if wrong:
        raise ConfigError(
            f"{' and '.join(wrong)}: not available in slabs",
            where=name,
            expected="a surface in space with a threshold, and nothing that needs the whole mesh",
            remedy="leave out `slabs` and use larger cells, or leave out " + " and ".join(wrong),
        )


def count_slabs(settings: Settings, grid: BackgroundGrid, volume: float | None, name: str) -> int:
    """Return the number of slabs, and raise an error if even these do not fit into memory.

    Parameters
    ----------
    settings
        How many are wanted.
    grid
        The background grid.
    volume
        About the volume of the mesh, in model units; None: that of the whole grid.
    name
        The model, for the message.

    Raises
    ------
    SamplingError
        With this number of slabs, the grid does not fit into the memory of this machine.
    """
    wanted, most = settings.memory.slabs, max(grid.shape[0] // LEAST, 1)
    full = grid.n_cells if volume is None else int(abs(volume) / grid.cell_size**3)
    n_kept, free = min(full, grid.n_cells), available_memory()
    if wanted == "auto":
        fits = (
            n
            for n in range(1, most + 1)
            if estimate_slabs(grid.n_cells, n_kept, n) <= _SHARE * free
        )
        wanted = next(fits, most)
    assert isinstance(wanted, int)
    needed = estimate_slabs(grid.n_cells, n_kept, min(wanted, most))
    if needed > free:
        raise SamplingError(
            f"meshing on the {grid.label} grid of {grid.n_cells:,} cells in "
            f"{min(wanted, most):,} slabs needs about {needed / 1e9:.3g} GB",
            where=name,
            expected=f"at most the {free / 1e9:.3g} GB that this machine has left",
            remedy="use more slabs (`--slabs auto` takes as many as fit), or fewer `grid.cells`",
        )
    return wanted
