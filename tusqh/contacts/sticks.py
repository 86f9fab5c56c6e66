"""Compiled functions that decide whether a vertex is good and search for better sticks.

A vertex is *good* if every material around it is a manifold with the topology that its cells, its
pinched edges and its ball imply.
"""

from __future__ import annotations

import numba
import numpy as np

#: Price, in elements, of a marked vertex that is not good, and of an unmarked one.
_BAD, _UNMARKED_BAD = 200.0, 40.0
#: Elements that the split of a cell adds.
_SPLIT = 6
_ALL = (1 << 48) - 1


@numba.njit(cache=True)
def _judge_around(octants, sectors, sticks, ball, tables):  # type: ignore[no-untyped-def]
    """Return whether a vertex is good, from the materials of its octants and sectors.

    `sticks` has the decided materials of pinched half-edges and `ball` that of a pinched vertex,
    -1 at others.
    """
    for a in range(8):
        k, mask, is_first = octants[a], 0, True
        for b in range(8):
            if octants[b] == k:
                mask |= 1 << b
                is_first &= b >= a
        if not is_first:
            continue
        region = 0
        for s in range(48):
            if sectors[s] == k:
                region |= 1 << s
        if not _has_topology(k == ball, k, mask, region, sticks, tables):
            return False
        if not (
            _is_connected(region, tables.next_to) and _is_connected(_ALL & ~region, tables.next_to)
        ):
            return False
    return True


@numba.njit(cache=True)
def _is_connected(region, next_to):  # type: ignore[no-untyped-def]
    """Return whether a set of sectors is connected; the empty set is."""
    seen = region & -region
    new = seen
    while new:
        grown = 0
        for s in range(48):
            if new >> s & 1:
                grown |= next_to[s]
        new = grown & region & ~seen
        seen |= new
    return seen == region


@numba.njit(cache=True)
def _has_topology(has_ball, k, mask, region, sticks, tables):  # type: ignore[no-untyped-def]
    """Return whether material k is joined as its cells and sticks, or its ball, require.

    The actual body consists of its octants, and of its sectors as a further body that touches some
    of them.  The required body consists of its octants, its pinched edges and, with the ball, all
    of them joined.  The two are compared by the joined octants and by the Euler characteristic.
    """
    touching, n_kites = 0, 0
    for a in range(8):
        if mask >> a & 1 and region & tables.of_octant[a]:
            touching |= 1 << a
    for q in range(12):
        both = mask >> tables.kites[q, 0] & mask >> tables.kites[q, 1] & 1
        if both and region & tables.of_kite[q]:
            n_kites += 1
    if region and not touching:
        return False
    euler = tables.euler[mask] + (region != 0) + n_kites
    for a in range(8):
        euler -= touching >> a & 1
    found, said = tables.parts[mask].copy(), tables.parts[mask].copy()
    _join(found, touching)
    expected = 1 if has_ball else tables.filled[mask]
    if has_ball:
        _join(said, mask)
    for e in range(6):
        if sticks[e] == k and not has_ball:
            around = 0
            for c in range(4):
                around |= mask & 1 << tables.around[e, c]
                expected -= mask >> tables.around[e, c] & 1
            expected += 1
            _join(said, around)
    return euler == expected and (found == said).all()


@numba.njit(cache=True)
def _join(parts, octants):  # type: ignore[no-untyped-def]
    """Join the parts of some octants, in place."""
    low = 8
    for a in range(8):
        if octants >> a & 1:
            low = min(low, parts[a])
    for a in range(8):
        if octants >> a & 1 and parts[a] != low:
            old = parts[a]
            for b in range(8):
                if parts[b] == old:
                    parts[b] = low


@numba.njit(cache=True)
def _cell_at(v, octant, field):  # type: ignore[no-untyped-def]
    """Return the number of the cell in an octant of a vertex."""
    for axis in range(3):
        v -= (1 - (octant >> axis & 1)) * field.steps[axis]
    return v


@numba.njit(cache=True)
def _look_around(v, octants, decided, field, tables):  # type: ignore[no-untyped-def]
    """Fill in the materials of the octants, and the decided ones of pinched edges, at a vertex."""
    for a in range(8):
        octants[a] = field.labels[_cell_at(v, a, field)]
    for e in range(6):
        low = v - (1 - (e & 1)) * field.steps[e // 2]
        decided[e] = field.sticks[e // 2, low] if field.is_pinched[e // 2, low] else -1


@numba.njit(cache=True)
def _face_at(v, q, field, tables):  # type: ignore[no-untyped-def]
    """Return the normal and number of the face of a kite, and whether it may be refined.

    Faces between two materials may be refined if both cells lie in the grid.
    """
    e, f = tables.kites[q, 2], tables.kites[q, 3]
    axis = 3 - e // 2 - f // 2
    low = v - (1 - (e & 1)) * field.steps[e // 2] - (1 - (f & 1)) * field.steps[f // 2]
    lower = low - field.steps[axis]
    is_inside = field.inside[lower] and field.inside[low]
    return axis, low, is_inside and field.labels[lower] != field.labels[low]


@numba.njit(cache=True)
def _has_corner(where, axis, low, field):  # type: ignore[no-untyped-def]
    """Return whether some corner of a face is among some vertices."""
    step_a, step_b = field.steps[axis - 2], field.steps[axis - 1]
    return where[low] or where[low + step_a] or where[low + step_b] or where[low + step_a + step_b]


@numba.njit(cache=True)
def _is_good(v, field, tables):  # type: ignore[no-untyped-def]
    """Return whether a vertex of the grid is good; all with elements for their balls are."""
    if field.has_ball[v]:
        return True
    octants, sectors = np.empty(8, np.int32), np.empty(48, np.int32)
    decided = np.empty(6, np.int32)
    _look_around(v, octants, decided, field, tables)
    for q in range(12):
        axis, low, is_refined = _face_at(v, q, field, tables)
        is_refined = is_refined and _has_corner(field.marked, axis, low, field)
        single = octants[tables.kites[q, field.sides[axis, low]]]
        for h in range(2):
            e = tables.kites[q, 2 + h]
            stick = field.sticks[e // 2, v - (1 - (e & 1)) * field.steps[e // 2]]
            ring = stick if stick >= 0 else single
            for side in range(2):
                own = octants[tables.kites[q, side]]
                sectors[4 * q + 2 * side + h] = ring if is_refined else own
    return _judge_around(octants, sectors, decided, field.ball[v], tables)


@numba.njit(cache=True)
def judge(vertices, field, tables):  # type: ignore[no-untyped-def]
    """Return which vertices of the grid are good, shape (r,), bool.

    Parameters
    ----------
    vertices
        Numbers of the vertices, shape (r,), int64.
    field
        See `tusqh.contacts.stick_field.Field`.
    tables
        See `tusqh.contacts.octants.Octants`.
    """
    found = np.empty(len(vertices), dtype=np.bool_)
    for i in range(len(vertices)):
        found[i] = _is_good(vertices[i], field, tables)
    return found


@numba.njit(cache=True)
def _price_face(lower, upper, rings, must, void):  # type: ignore[no-untyped-def]
    """Return the elements that a face adds, and whether it splits its lower and upper cell."""
    common, is_one = np.int32(-1), not must
    for ring in rings:
        if ring >= 0:
            if common >= 0 and ring != common:
                is_one = False
            common = ring
    if is_one and common == lower:
        return np.int64(lower != void) - np.int64(upper != void), False, True
    if is_one and common == upper:
        return np.int64(upper != void) - np.int64(lower != void), True, False
    price = 0
    for ring in rings:
        price += ring != void if ring >= 0 else lower != void and upper != void
    return price, True, True


@numba.njit(cache=True)
def _list_options(v, octants, options, field, tables):  # type: ignore[no-untyped-def]
    """Fill in the possible labels of every stick at a vertex and the prices at its other end.

    The present label comes first.  The label of a pinched edge is decided.
    """
    labels, price, number = options
    for e in range(6):
        axis, step = e // 2, field.steps[e // 2]
        other = v + step if e & 1 else v - step
        low = min(v, other)
        old = field.sticks[axis, low]
        labels[e, 0], number[e] = old, 1
        for c in range(4):
            a = tables.around[e, c]
            is_new = not field.is_pinched[axis, low] and field.inside[_cell_at(v, a, field)]
            k = octants[a]
            for at in range(number[e]):
                is_new &= labels[e, at] != k
            if is_new:
                labels[e, number[e]] = k
                number[e] += 1
        for at in range(number[e]):
            field.sticks[axis, low] = labels[e, at]
            bad = _BAD if field.marked[other] else _UNMARKED_BAD
            price[e, at] = 0.0 if _is_good(other, field, tables) else bad
        field.sticks[axis, low] = old


@numba.njit(cache=True)
def _price_faces(v, octants, options, faces, field, tables, void):  # type: ignore[no-untyped-def]
    """Fill in what every face at a vertex adds and splits, for all pairs of its two sticks."""
    labels, _, number = options
    prices, splits, is_refined = faces
    prices[:], splits[:] = 0, 0
    rings = np.empty(4, dtype=np.int32)
    for q in range(12):
        e, f = tables.kites[q, 2], tables.kites[q, 3]
        axis, low, is_refined[q] = _face_at(v, q, field, tables)
        if not is_refined[q]:
            continue
        must = _has_corner(field.has_ball, axis, low, field)
        # The sticks at the vertex come first, then those at the two other edges.
        rings[2] = field.sticks[e // 2, low + (f & 1) * field.steps[f // 2]]
        rings[3] = field.sticks[f // 2, low + (e & 1) * field.steps[e // 2]]
        lower, upper = tables.kites[q, 0], tables.kites[q, 1]
        for i in range(number[e]):
            for j in range(number[f]):
                rings[0], rings[1] = labels[e, i], labels[f, j]
                price, in_lower, in_upper = _price_face(
                    octants[lower], octants[upper], rings, must, void
                )
                prices[q, i, j] = price
                splits[q, i, j] = np.int64(in_lower) << lower | np.int64(in_upper) << upper


@numba.njit(cache=True)
def _search(v, octants, decided, options, faces, field, tables, void):  # type: ignore[no-untyped-def]
    """Return the cheapest choice of every stick, as digits of one number; 0 is the present one."""
    labels, price, number = options
    prices, splits, is_refined = faces
    sectors, digit = np.empty(48, dtype=np.int32), np.zeros(6, dtype=np.int64)
    total, best, best_code = 1, np.inf, 0
    for e in range(6):
        total *= number[e]
    for code in range(total):
        rest, cost, split = code, 0.0, 0
        for e in range(6):
            digit[e] = rest % number[e]
            rest //= number[e]
            cost += price[e, digit[e]]
        for q in range(12):
            i, j = digit[tables.kites[q, 2]], digit[tables.kites[q, 3]]
            cost += prices[q, i, j]
            split |= splits[q, i, j]
        for a in range(8):
            cost += _SPLIT * (split >> a & 1 and octants[a] != void)
        if cost >= best:
            continue
        for q in range(12):
            for h in range(2):
                e = tables.kites[q, 2 + h]
                for side in range(2):
                    own = octants[tables.kites[q, side]]
                    ring = labels[e, digit[e]] if is_refined[q] else own
                    sectors[4 * q + 2 * side + h] = ring
        is_good = field.has_ball[v]
        if not (is_good or _judge_around(octants, sectors, decided, field.ball[v], tables)):
            cost += _BAD
        if cost < best:
            best, best_code = cost, code
    return best_code


@numba.njit(cache=True)
def improve(vertices, field, void, tables):  # type: ignore[no-untyped-def]
    """Change sticks at marked vertices if that makes vertices good or saves elements.

    All labels of the six sticks are tried, with the vertices at their other ends.

    Parameters
    ----------
    vertices
        Numbers of marked vertices, shape (r,), int64.
    field
        See `tusqh.contacts.stick_field.Field`; its sticks change.
    void
        The material whose elements cost nothing.
    tables
        See `tusqh.contacts.octants.Octants`.

    Returns
    -------
    n_changed : int
        Number of sticks that changed.
    """
    octants, decided = np.empty(8, np.int32), np.empty(6, np.int32)
    options = (np.empty((6, 4), np.int32), np.empty((6, 4)), np.empty(6, np.int64))
    shape = (12, 4, 4)
    faces = (np.empty(shape, np.int64), np.empty(shape, np.int64), np.empty(12, np.bool_))
    n_changed = 0
    for v in vertices:
        _look_around(v, octants, decided, field, tables)
        _list_options(v, octants, options, field, tables)
        if options[2].max() == 1:
            continue
        _price_faces(v, octants, options, faces, field, tables, void)
        code = _search(v, octants, decided, options, faces, field, tables, void)
        for e in range(6):
            low = v if e & 1 else v - field.steps[e // 2]
            choice = code % options[2][e]
            code //= options[2][e]
            n_changed += choice > 0
            field.sticks[e // 2, low] = options[0][e, choice]
    return n_changed
