"""Give every part of a geometry a name of its own."""

from __future__ import annotations

from collections.abc import Sequence

from tusqh.contacts.material_fractions import VOID
from tusqh.geometry.kinds import Surface
from tusqh.geometry.remark import Remark
from tusqh.geometry.split_parts import names_of

#: Number of renamed parts that a remark lists.
_MOST = 8


def name_parts(parts: Sequence[Surface]) -> tuple[dict[str, Surface], tuple[Remark, ...]]:
    """Return parts by their names in the file, and remarks on names that were changed.

    A part without a name is called ``part_K``, where K is its number from 1.  A name that an
    earlier part or the void has gets a number at its end.

    Parameters
    ----------
    parts
        The parts, in the order of the file.

    Returns
    -------
    named, remarks
        The parts in the same order, and at most one remark.
    """
    stated = names_of(parts)
    taken = {VOID, *stated}
    found: dict[str, Surface] = {}
    changed = []
    for k, (part, own) in enumerate(zip(parts, stated, strict=True)):
        name = " ".join(own.split()) or f"part_{k + 1}"
        if name in found or name == VOID or (not own and name in taken):
            number = 2
            while f"{name}_{number}" in taken or f"{name}_{number}" in found:
                number += 1
            changed.append(f"part {k + 1} {name!r}, now {name}_{number}")
            name = f"{name}_{number}"
        found[name] = part
    if not changed:
        return found, ()
    shown = "; ".join(changed[:_MOST]) + ("; ..." if len(changed) > _MOST else "")
    what = f"names of parts that an earlier part or the void has ({shown})"
    return found, (Remark("changed", what, len(changed)),)
