"""Compiled functions that decide whether a vertex is good and search for better sticks.

A vertex is *good* if every material around it is a manifold with the topology that its cells, its
pinched edges and its ball imply.
"""

from __future__ import annotations

import numba
import numpy as np

#: Price, in elements, of a marked vertex that is not good, and of an unmarked one.
_BAD, _UNMARKED_BAD = 200.0, 40.0
#: Elements that the split of a cell adds, and the set of all sectors.
_SPLIT, _ALL = 6, (1 << 48) - 1
#: Verdict of a vertex that has not been judged as it is.
_UNKNOWN = -1


@numba.njit(cache=True)
def _workspace():  # type: ignore[no-untyped-def]
    """Return arrays for what lies around one vertex.

    They are the materials of its octants; the first octant with the same material as each octant,
    as each stick, and as each decided stick (-1 if there is none); whether each kite is refined,
    and the octant that owns its rings without sticks; and the sectors of each material, as bits.
    """
    octants, first = np.empty(8, np.int32), np.empty(8, np.int64)
    sticks, decided = np.empty(6, np.int64), np.empty(6, np.int64)
    is_refined, single = np.empty(12, np.bool_), np.empty(12, np.int64)
    return octants, first, sticks, decided, is_refined, single, np.empty(8, np.int64)


@numba.njit(cache=True)
def _find(material, octants):  # type: ignore[no-untyped-def]
    """Return the first octant with a material, -1 if there is none."""
    for a in range(8):
        if octants[a] == material:
            return a
    return -1


@numba.njit(cache=True)
def _judge_around(ball, around, tables):  # type: ignore[no-untyped-def]
    """Return whether a vertex is good, see `_workspace`; the material of its ball may be -1."""
    octants, first, sticks, decided, is_refined, single, regions = around
    kites = tables.kites
    regions[:] = 0
    for q in range(12):
        if is_refined[q]:
            for h in range(2):
                ring = sticks[kites[q, 2 + h]]
                regions[ring if ring >= 0 else first[single[q]]] |= 5 << 4 * q + h
        else:
            regions[first[kites[q, 0]]] |= 3 << 4 * q
            regions[first[kites[q, 1]]] |= 12 << 4 * q
    for a in range(8):
        if first[a] != a:
            continue
        mask = 0
        for b in range(8):
            mask |= (first[b] == a) << b
        if not _has_topology(octants[a] == ball, a, mask, regions[a], decided, tables):
            return False
        for region in (regions[a], _ALL & ~regions[a]):
            if not _is_connected(region, tables.next_to):
                return False
    return True


@numba.njit(cache=True)
def _is_connected(region, next_to):  # type: ignore[no-untyped-def]
    """Return whether a set of sectors is connected; the empty set is."""
    seen = new = region & -region
    while new:
        grown = 0
        for byte in range(6):
            grown |= next_to[byte, new >> 8 * byte & 255]
        new = grown & region & ~seen
        seen |= new
    return seen == region


@numba.njit(cache=True)
def _has_topology(has_ball, k, mask, region, decided, tables):  # type: ignore[no-untyped-def]
    """Return whether material k is joined as its cells and sticks, or its ball, require.

    The actual body consists of its octants, and of its sectors as a further body that touches some
    of them.  The required body consists of its octants, its pinched edges and, with the ball, all
    of them joined.  The two are compared by the joined octants and by the Euler characteristic.
    """
    of_octant, of_kite, kites = tables.of_octant, tables.of_kite, tables.kites
    touching, n_kites, n_touching = 0, 0, 0
    for a in range(8):
        if mask >> a & 1 and region & of_octant[a]:
            touching |= 1 << a
            n_touching += 1
    for q in range(12):
        if mask >> kites[q, 0] & mask >> kites[q, 1] & 1 and region & of_kite[q]:
            n_kites += 1
    if region and not touching:
        return False
    euler = tables.euler[mask] + (region != 0) + n_kites - n_touching
    said = tables.parts[mask]
    found = _join(said, touching)
    expected = 1 if has_ball else tables.filled[mask]
    if has_ball:
        said = _join(said, mask)
    else:
        for e in range(6):
            if decided[e] == k:
                octants = 0
                for c in range(4):
                    octants |= mask & 1 << tables.around[e, c]
                    expected -= mask >> tables.around[e, c] & 1
                expected += 1
                said = _join(said, octants)
    return euler == expected and found == said


@numba.njit(cache=True)
def _join(parts, octants):  # type: ignore[no-untyped-def]
    """Return the parts of octants, four bits for each, after joining those of some octants."""
    low, joined = 15, 0
    for a in range(8):
        if octants >> a & 1:
            part = parts >> 4 * a & 15
            low = min(low, part)
            joined |= 1 << part
    found = parts
    for a in range(8):
        part = parts >> 4 * a & 15
        if joined >> part & 1:
            found ^= (part ^ low) << 4 * a
    return found


@numba.njit(cache=True)
def _look_around(v, around, field, tables):  # type: ignore[no-untyped-def]
    """Fill in what lies around a vertex, see `_workspace`."""
    octants, first, sticks, decided, is_refined, single, _ = around
    for a in range(8):
        octants[a] = field.labels[v + field.octant[a]]
        first[a] = _find(octants[a], octants)
    for e in range(6):
        low = v - (1 - (e & 1)) * field.steps[e // 2]
        sticks[e] = _find(field.sticks[e // 2, low], octants)
        decided[e] = sticks[e] if field.is_pinched[e // 2, low] else -1
    for q in range(12):
        axis, low = tables.normals[q], v + field.face[q]
        is_refined[q] = field.between[low] >> axis & 1 and _has_corner(
            field.marked, axis, low, field.steps
        )
        single[q] = tables.kites[q, field.sides[axis, low]]


@numba.njit(cache=True)
def _has_corner(where, axis, low, steps):  # type: ignore[no-untyped-def]
    """Return whether some corner of a face is among some vertices."""
    step_a, step_b = steps[axis - 2], steps[axis - 1]
    return where[low] or where[low + step_a] or where[low + step_b] or where[low + step_a + step_b]


@numba.njit(cache=True)
def judge(vertices, field, tables):  # type: ignore[no-untyped-def]
    """Return which vertices of the grid are good, shape (r,), bool (those with has_ball are).

    Parameters
    ----------
    vertices
        Numbers of the vertices, shape (r,), int64.
    field
        See `tusqh.contacts.stick_field.Field`.
    tables
        See `tusqh.contacts.octants.Octants`.
    """
    found, around = np.empty(len(vertices), dtype=np.bool_), _workspace()
    for i, v in enumerate(vertices):
        _look_around(v, around, field, tables)
        found[i] = field.has_ball[v] or _judge_around(field.ball[v], around, tables)
    return found


@numba.njit(cache=True)
def _price_face(lower, upper, rings, must, void):  # type: ignore[no-untyped-def]
    """Return the elements that a face adds, and whether it splits its lower (1) and upper cell (2).

    A face whose rings have the material of one of its cells stays whole, unless it `must` not.
    """
    common, is_one, price = np.int32(-1), np.bool_(not must), 0
    for ring in rings:
        is_one &= ring < 0 or common < 0 or ring == common
        common = max(common, ring)
        price += ring != void if ring >= 0 else lower != void and upper != void
    if is_one and common == lower:
        return np.int64(lower != void) - np.int64(upper != void), 2
    if is_one and common == upper:
        return np.int64(upper != void) - np.int64(lower != void), 1
    return price, 3


@numba.njit(cache=True)
def _list_options(v, octants, options, beyond, field, tables):  # type: ignore[no-untyped-def]
    """Fill in the labels that every stick may have, the present one first, and their prices."""
    labels, price, number = options
    for e in range(6):
        axis, step = e // 2, field.steps[e // 2]
        other = v + step if e & 1 else v - step
        low = min(v, other)
        labels[e, 0], number[e] = field.sticks[axis, low], 1
        for c in range(4):
            a = tables.around[e, c]
            is_new = not field.is_pinched[axis, low] and field.inside[v + field.octant[a]]
            k = octants[a]
            for at in range(number[e]):
                is_new &= labels[e, at] != k
            if is_new:
                labels[e, number[e]] = k
                number[e] += 1
        price[e] = 0.0
        if field.has_ball[other] or (number[e] == 1 and field.verdict[other] == 1):
            continue
        bad = _BAD if field.marked[other] else _UNMARKED_BAD
        _look_around(other, beyond, field, tables)
        for at in range(number[e]):
            is_good = field.verdict[other]
            if at or is_good == _UNKNOWN:
                beyond[2][e ^ 1] = _find(labels[e, at], beyond[0])
                is_good = _judge_around(field.ball[other], beyond, tables)
            if at == 0:
                field.verdict[other] = is_good
            price[e, at] = 0.0 if is_good else bad


@numba.njit(cache=True)
def _price_faces(v, octants, options, faces, field, tables, void):  # type: ignore[no-untyped-def]
    """Fill in what every face at a vertex adds and splits, for all pairs of its two sticks."""
    labels, _, number = options
    prices, splits, is_refined = faces
    prices[:], splits[:] = 0, 0
    rings = np.empty(4, dtype=np.int32)
    for q in range(12):
        e, f = tables.kites[q, 2], tables.kites[q, 3]
        axis, low = tables.normals[q], v + field.face[q]
        is_refined[q] = field.between[low] >> axis & 1
        if not is_refined[q]:
            continue
        must = _has_corner(field.has_ball, axis, low, field.steps)
        # The sticks at the vertex come first, then those at the two other edges.
        rings[2] = field.sticks[e // 2, low + (f & 1) * field.steps[f // 2]]
        rings[3] = field.sticks[f // 2, low + (e & 1) * field.steps[e // 2]]
        lower, upper = tables.kites[q, 0], tables.kites[q, 1]
        for i in range(number[e]):
            for j in range(number[f]):
                rings[0], rings[1] = labels[e, i], labels[f, j]
                price, split = _price_face(octants[lower], octants[upper], rings, must, void)
                prices[q, i, j] = price
                splits[q, i, j] = (split & 1) << lower | split >> 1 << upper


@numba.njit(cache=True)
def _search(v, around, options, faces, field, tables, void):  # type: ignore[no-untyped-def]
    """Return the cheapest choice of every stick, as digits of one number; 0 is the present one."""
    octants, _, sticks, _, is_refined, _, _ = around
    labels, price, number = options
    prices, splits, may_be_refined = faces
    is_refined[:] = may_be_refined
    digit, best, best_code = np.zeros(6, dtype=np.int64), np.inf, 0
    for code in range(number.prod()):
        rest, cost, split = code, 0.0, 0
        for e in range(6):
            digit[e] = rest % number[e]
            rest //= number[e]
            cost += price[e, digit[e]]
        if cost - 12 >= best:  # No face saves more than one element.
            continue
        for q in range(12):
            i, j = digit[tables.kites[q, 2]], digit[tables.kites[q, 3]]
            cost += prices[q, i, j]
            split |= splits[q, i, j]
        for a in range(8):
            cost += _SPLIT * (split >> a & 1 and octants[a] != void)
        if cost >= best:
            continue
        for e in range(6):
            sticks[e] = _find(labels[e, digit[e]], octants)
        if not (field.has_ball[v] or _judge_around(field.ball[v], around, tables)):
            cost += _BAD
        if cost < best:
            best, best_code = cost, code
    return best_code


@numba.njit(cache=True)
def _touch(low, axis, field):  # type: ignore[no-untyped-def]
    """Note that a stick has changed, for the marked vertices that look at it."""
    for end in (low, low + field.steps[axis]):
        field.verdict[end] = _UNKNOWN
        field.stale[end] = field.marked[end]
        for k in range(3):
            for v in (end - field.steps[k], end + field.steps[k]):
                field.stale[v] = field.marked[v]


@numba.njit(cache=True)
def improve(vertices, field, void, tables):  # type: ignore[no-untyped-def]
    """Change sticks at marked vertices if that makes vertices good or saves elements.

    All labels of the six sticks are tried.  Vertices that are not stale would stay as they are.

    Parameters
    ----------
    vertices
        Numbers of marked vertices, shape (r,), int64.
    field
        See `tusqh.contacts.stick_field.Field`; its sticks change, and what is stale.
    void
        The material whose elements cost nothing.
    tables
        See `tusqh.contacts.octants.Octants`.

    Returns
    -------
    n_changed : int
        Number of sticks that changed.
    """
    around, beyond = _workspace(), _workspace()
    options = (np.empty((6, 4), np.int32), np.empty((6, 4)), np.empty(6, np.int64))
    prices, splits = np.empty((12, 4, 4), np.int64), np.empty((12, 4, 4), np.int64)
    faces = (prices, splits, np.empty(12, np.bool_))
    n_changed = 0
    for v in vertices:
        if not field.stale[v]:
            continue
        field.stale[v] = False
        _look_around(v, around, field, tables)
        _list_options(v, around[0], options, beyond, field, tables)
        if options[2].max() == 1:
            continue
        _price_faces(v, around[0], options, faces, field, tables, void)
        code = _search(v, around, options, faces, field, tables, void)
        for e in range(6):
            low = v if e & 1 else v - field.steps[e // 2]
            choice = code % options[2][e]
            code //= options[2][e]
            if choice > 0:
                n_changed += 1
                field.sticks[e // 2, low] = options[0][e, choice]
                _touch(low, e // 2, field)
    return n_changed
