"""Compiled functions that decide whether a vertex is good and search for better sticks.

A vertex is *good* if every material around it is a manifold with the topology that its cells, its
pinched edges and a ball of one of its materials imply.
"""

from __future__ import annotations

import numba
import numpy as np

#: Cost of a marked vertex that is not good, and of an unmarked one, which then must be marked.
_BAD, _UNMARKED_BAD = 1e6, 0.3
#: Cost of changing the present stick, so that nothing changes without a gain.
_CHANGE = 1e-4
_ALL = (1 << 48) - 1


@numba.njit(cache=True)
def judge_around(octants, sectors, sticks, is_marked, tables):  # type: ignore[no-untyped-def]
    """Return the octants, as bits, whose material may have the ball; 0 if the vertex is bad.

    Parameters
    ----------
    octants, sectors, sticks
        Materials of the octants, shape (8,), of the sectors, shape (48,), and of the sticks at the
        half-edges, shape (6,), -1 if there is none; int32.
    is_marked
        Whether all faces at the vertex are refined.
    tables
        See `tusqh.contacts.octants.Octants`.
    """
    allowed = 255
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
        if is_marked:
            of_sticks = 0
            for e in range(6):
                of_sticks |= (sticks[e] == k) << e
            if tables.splits[of_sticks]:
                return 0
        elif not (
            _is_connected(region, tables.next_to) and _is_connected(_ALL & ~region, tables.next_to)
        ):
            return 0
        as_cells, as_ball = _compare(octants, k, mask, region, sticks, tables)
        for b in range(8):
            if not (as_ball if octants[b] == k else as_cells):
                allowed &= ~(1 << b)
    return allowed


@numba.njit(cache=True)
def _is_connected(region, next_to):  # type: ignore[no-untyped-def]
    """Return whether a set of sectors is connected; the empty set is."""
    seen = region & -region
    while True:
        grown = seen
        for s in range(48):
            if seen >> s & 1:
                grown |= next_to[s]
        grown &= region
        if grown == seen:
            return seen == region
        seen = grown


@numba.njit(cache=True)
def _compare(octants, k, mask, region, sticks, tables):  # type: ignore[no-untyped-def]
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
        return False, False
    euler = tables.euler[mask] + (region != 0) + n_kites
    for a in range(8):
        euler -= touching >> a & 1
    found, said = tables.parts[mask].copy(), tables.parts[mask].copy()
    _join(found, touching)
    expected = tables.euler[mask] - (mask == 255)
    for e in range(6):
        around, n, n_faces = 0, 0, 0
        for c in range(4):
            here = mask >> tables.around[e, c] & 1
            around |= here << tables.around[e, c]
            n += here
            n_faces += here & (mask >> tables.around[e, (c + 1) % 4])
        if n == 4 or (n > 0 and sticks[e] == k):
            expected += 1 - (n - n_faces)
            _join(said, around)
    is_one = True
    as_cells = euler == expected
    low = -1
    for a in range(8):
        if mask >> a & 1:
            low = found[a] if low < 0 else low
            is_one &= found[a] == low
            as_cells &= found[a] == said[a]
    return as_cells, is_one and euler == 1


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
def _octant_steps(steps):  # type: ignore[no-untyped-def]
    """Return the offsets from the number of a vertex to those of its octants."""
    found = np.zeros(8, dtype=np.int64)
    for a in range(8):
        for axis in range(3):
            if not a >> axis & 1:
                found[a] -= steps[axis]
    return found


@numba.njit(cache=True)
def _judge(v, field, tables):  # type: ignore[no-untyped-def]
    """Return the result of `judge_around` for a vertex of the grid."""
    octant = _octant_steps(field.steps)
    octants = np.empty(8, dtype=np.int32)
    sectors = np.empty(48, dtype=np.int32)
    sticks = np.full(6, -1, dtype=np.int32)
    for a in range(8):
        octants[a] = field.labels[v + octant[a]]
    for e in range(6):
        step = field.steps[e // 2]
        other = v + step if e & 1 else v - step
        if field.marked[v] or field.marked[other]:
            sticks[e] = field.sticks[e // 2, min(v, other)]
    is_plain = True
    for q in range(12):
        e, f = tables.kites[q, 2], tables.kites[q, 3]
        step_e, step_f = field.steps[e // 2], field.steps[f // 2]
        lowest = v - (1 - (e & 1)) * step_e - (1 - (f & 1)) * step_f
        is_refined = (
            field.marked[lowest]
            or field.marked[lowest + step_e]
            or field.marked[lowest + step_f]
            or field.marked[lowest + step_e + step_f]
        )
        is_plain &= not is_refined
        single = tables.kites[q, field.sides[3 - e // 2 - f // 2, lowest]]
        for h in range(2):
            stick = sticks[tables.kites[q, 2 + h]]
            for side in range(2):
                own = octants[tables.kites[q, side]]
                ring = stick if stick >= 0 else octants[single]
                sectors[4 * q + 2 * side + h] = ring if is_refined else own
    if is_plain:
        return 255
    return judge_around(octants, sectors, sticks, field.marked[v], tables)


@numba.njit(cache=True)
def judge(vertices, field, tables):  # type: ignore[no-untyped-def]
    """Return the results of `judge_around` for some vertices of the grid, shape (r,).

    Parameters
    ----------
    vertices
        Numbers of the vertices, shape (r,), int64.
    field
        See `tusqh.contacts.stick_field.Field`.
    tables
        See `tusqh.contacts.octants.Octants`.
    """
    found = np.empty(len(vertices), dtype=np.int64)
    for i in range(len(vertices)):
        found[i] = _judge(vertices[i], field, tables)
    return found


@numba.njit(cache=True)
def _cost_at(v, field, costs, tables):  # type: ignore[no-untyped-def]
    """Return the cost of the best ball that the sticks at a vertex allow."""
    allowed = _judge(v, field, tables)
    if allowed == 0:
        return _BAD if field.marked[v] else _UNMARKED_BAD
    row = costs.vertex_row[v]
    if row < 0:
        return 0.0
    best = _BAD
    for a in range(8):
        if allowed >> a & 1:
            best = min(best, costs.vertex_cost[row, a])
    return best


@numba.njit(cache=True)
def _is_wanting(v, octants, field, costs, tables):  # type: ignore[no-untyped-def]
    """Return whether a vertex is bad, or its ball or a pinched edge at it is overruled."""
    if _cost_at(v, field, costs, tables) > 0:
        return True
    for e in range(6):
        low = v if e & 1 else v - field.steps[e // 2]
        row = costs.edge_row[e // 2, low]
        if row >= 0:
            for c in range(4):
                is_stick = octants[tables.around[e, c]] == field.sticks[e // 2, low]
                if is_stick and costs.edge_cost[row, c] > 0:
                    return True
    return False


@numba.njit(cache=True)
def _list_options(v, octants, options, field, costs, tables):  # type: ignore[no-untyped-def]
    """Fill in the possible labels of every stick at a vertex and their prices.

    A price includes the vote of the edge, the cost at its other end, and the cost of a change.
    Return the price of the present labels.
    """
    labels, price, number = options
    present = 0.0
    for e in range(6):
        axis, step = e // 2, field.steps[e // 2]
        other = v + step if e & 1 else v - step
        low = min(v, other)
        row, old = costs.edge_row[axis, low], field.sticks[axis, low]
        number[e] = 0
        for c in range(4):
            k, at = octants[tables.around[e, c]], 0
            while at < number[e] and labels[e, at] != k:
                at += 1
            if at < number[e]:
                continue
            labels[e, at] = k
            number[e] += 1
            field.sticks[axis, low] = k
            price[e, at] = _cost_at(other, field, costs, tables)
            if row >= 0:
                price[e, at] += costs.edge_cost[row, c]
            if k == old:
                present += price[e, at]
            else:
                price[e, at] += _CHANGE
        field.sticks[axis, low] = old
    return present


@numba.njit(cache=True)
def _search(octants, options, ball_cost, best, tables):  # type: ignore[no-untyped-def]
    """Return the cheapest good sticks of a vertex, or -1 for all if none cost less than `best`."""
    labels, price, number = options
    sectors = np.empty(48, dtype=np.int32)
    now, found = np.empty(6, dtype=np.int32), np.full(6, -1, dtype=np.int32)
    total = 1
    for e in range(6):
        total *= number[e]
    for code in range(total):
        rest, cost = code, 0.0
        for e in range(6):
            now[e] = labels[e, rest % number[e]]
            cost += price[e, rest % number[e]]
            rest //= number[e]
        if cost >= best - _CHANGE / 2:
            continue
        for q in range(12):
            for h in range(2):
                sectors[4 * q + h] = sectors[4 * q + 2 + h] = now[tables.kites[q, 2 + h]]
        allowed = judge_around(octants, sectors, now, True, tables)
        least = _BAD
        for a in range(8):
            if allowed >> a & 1:
                least = min(least, ball_cost[a])
        if cost + least < best - _CHANGE / 2:
            best = cost + least
            found[:] = now
    return found


@numba.njit(cache=True)
def improve(vertices, field, costs, frozen, tables):  # type: ignore[no-untyped-def]
    """Change sticks at marked vertices if that lowers the cost.

    All combinations of labels of the six sticks, at most 4**6, are tried; their costs at the other
    ends are included.

    Parameters
    ----------
    vertices
        Numbers of marked vertices, shape (r,), int64.
    field
        See `tusqh.contacts.stick_field.Field`; its sticks change.
    costs
        See `tusqh.contacts.stick_field.Costs`.
    frozen
        Vertices that do not change, shape (n_v,), bool.
    tables
        See `tusqh.contacts.octants.Octants`.

    Returns
    -------
    n_changed : int
        Number of sticks that changed.
    """
    octant = _octant_steps(field.steps)
    octants = np.empty(8, dtype=np.int32)
    options = (np.empty((6, 4), np.int32), np.empty((6, 4)), np.empty(6, np.int64))
    nothing = np.zeros(8)
    n_changed = 0
    for v in vertices:
        for a in range(8):
            octants[a] = field.labels[v + octant[a]]
        if frozen[v] or not _is_wanting(v, octants, field, costs, tables):
            continue
        best = _cost_at(v, field, costs, tables)
        best += _list_options(v, octants, options, field, costs, tables)
        row = costs.vertex_row[v]
        ball_cost = nothing if row < 0 else costs.vertex_cost[row]
        found = _search(octants, options, ball_cost, best, tables)
        for e in range(6):
            low = v if e & 1 else v - field.steps[e // 2]
            if found[e] >= 0:
                n_changed += found[e] != field.sticks[e // 2, low]
                field.sticks[e // 2, low] = found[e]
    return n_changed
