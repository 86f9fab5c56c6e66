"""Select the spatial part of an image with channels, colours or times."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from tusqh.errors import GeometryError


def take_space(
    where: str, voxels: NDArray[Any], others: Sequence[str], *, channel: int | None = None
) -> NDArray[Any]:
    """Return the part of an image that lies in space.

    Parameters
    ----------
    where
        The file, for messages.
    voxels
        The image, with any number of axes.
    others
        For each axis a plural noun, such as "channels", or "" for a direction of space.
    channel
        The entry to take along the axis that is not a direction of space.

    Raises
    ------
    GeometryError
        There are several channels but none is chosen, or the chosen one does not exist.
    """
    single = tuple(i for i, name in enumerate(others) if name and voxels.shape[i] == 1)
    voxels = voxels.squeeze(single) if single else voxels
    others = [name for i, name in enumerate(others) if i not in single]
    named = [(i, name) for i, name in enumerate(others) if name]
    sizes = " and ".join(f"{voxels.shape[i]} {name}" for i, name in named)
    if len(named) > 1:
        raise GeometryError(
            f"the image has {sizes}",
            where=where,
            expected="three directions of space, and at most one axis more",
            remedy="export one of each from the program that wrote it",
        )
    if not named:
        if channel not in (None, 0):
            raise GeometryError(
                f"`channel` is {channel}, and the image has only one channel",
                where=where,
                expected="no `channel`, or 0",
                remedy="remove `channel`",
            )
        return voxels
    axis, _ = named[0]
    if len(others) != 4:
        raise GeometryError(
            f"the image has {sizes} and {len(others) - 1} directions of space",
            where=where,
            expected="grey values along three directions of space",
            remedy="export them as slices if they are one, or give a stack of several slices",
        )
    if channel is None or channel >= voxels.shape[axis]:
        chosen = "" if channel is None else f", and `channel` is {channel}"
        raise GeometryError(
            f"the image has {sizes}{chosen}",
            where=where,
            expected="grey values along three directions of space",
            remedy=f"choose one with `channel`, from 0 to {voxels.shape[axis] - 1}, "
            "or export them as slices if they are a direction of space",
        )
    taken: NDArray[Any] = voxels.take(channel, axis=axis)
    return taken
