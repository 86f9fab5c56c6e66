"""What the Python call and the command line ask for, as a model's block of the configuration."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from numbers import Integral, Real
from typing import Any, get_args

from tusqh.errors import ConfigError
from tusqh.sampling.field import Sampler
from tusqh.sampling.fractions import Domain, Orientation, Rule
from tusqh.settings.policy import BridgeMode, MixedPinches
from tusqh.threshold.goals import Wanted, find_empty

#: Keys of a block by the stage that reads them, as in the rules of the workflow.
SAMPLING = ("samples", "domain", "rule", "orientation", "sampler", "tolerance")
POLICY = ("mixed_pinches", "bridges", "components", "holes", "voids")
GOALS = ("threshold", "target", "persistence", "volume")

#: What the configuration allows for keys that take a number: lowest, highest, and whether the
#: lowest one is allowed.
_NUMBERS = {
    "threshold": (0.0, 1.0, False),
    "persistence": (0.0, 1.0, False),
    "tolerance": (1e-12, 0.01, True),
}

#: The same for criteria of features, and whether only whole numbers are.
_CRITERIA = {
    "min_cells": (1, math.inf, True),
    "min_volume": (0, math.inf, False),
    "min_persistence": (0, 1, False),
    "keep": (0, math.inf, True),
}

#: What the configuration allows for keys that take a word.
_WORDS = {
    "domain": get_args(Domain),
    "rule": get_args(Rule),
    "orientation": get_args(Orientation),
    "sampler": get_args(Sampler),
    "mixed_pinches": get_args(MixedPinches),
    "bridges": get_args(BridgeMode),
    "volume": ("match",),
}

Settings = dict[str, Any]
Betti = Sequence[Wanted | None]


def to_settings(
    *,
    cells: int | Sequence[int] | None = None,
    cell_size: float | None = None,
    betti: Betti | None = None,
    window: Sequence[Sequence[float]] | None = None,
    **others: Any,
) -> Settings:
    """Return arguments of `tusqh.mesh` as a model's block of the configuration, checked.

    Raises
    ------
    ConfigError
        Naming the argument, what was found and what is allowed.

    Examples
    --------
    >>> to_settings(cells=32, betti=(1, None, {"max": 2}), rule="clamped", threshold=None)
    {'grid': {'cells': 32}, 'rule': 'clamped', 'target': {'betti_0': 1, 'betti_2': {'max': 2}}}
    """
    settings = {"grid": _to_grid(cells, cell_size)}
    settings |= {key: value for key, value in others.items() if value is not None}
    if window is not None:
        settings["window"] = _to_window(window)
    if betti is not None:
        settings["target"] = _to_target(betti)
    for key, words in _WORDS.items():
        if settings.get(key, words[0]) not in words:
            raise _wrong(key, settings[key], "one of " + ", ".join(words))
    for key, (low, high, has_low) in _NUMBERS.items():
        value: Any = settings.get(key, high)
        if not _is_number(value) or not low <= value <= high or (value == low and not has_low):
            raise _wrong(key, value, f"a number {'from' if has_low else 'above'} {low} to {high}")
    for key in ("components", "holes", "voids"):
        _require_criteria(key, settings.get(key, {}))
    _require_keys("image", settings.get("image", {}), ["voxel_size", "empty", "full"])
    goals = [goal for goal in GOALS if goal in settings]
    if len(goals) > 1:
        names = " and ".join("betti" if goal == "target" else goal for goal in goals)
        raise _wrong("goals", names, "one of them: each says how to choose the threshold")
    return settings


def pick(settings: Mapping[str, Any], keys: Sequence[str]) -> Settings:
    """Return those settings of a block that are given.

    >>> pick({"grid": {"cells": 8}, "samples": 4}, ("samples", "rule"))
    {'samples': 4}
    """
    return {key: settings[key] for key in keys if key in settings}


def _to_grid(cells: int | Sequence[int] | None, cell_size: float | None) -> Settings:
    if cells is not None and cell_size is not None:
        raise _wrong("cells", f"{cells} with cell_size = {cell_size}", "one of the two")
    if cell_size is not None:
        if not _is_number(cell_size) or not cell_size > 0:
            raise _wrong("cell_size", cell_size, "a positive length, in units of the geometry")
        return {"cell_size": float(cell_size)}
    if cells is None:
        return {"cells": 64}
    numbers = list(cells) if isinstance(cells, Sequence) else [cells]
    if not numbers or not all(_is_count(n) and n > 0 for n in numbers):
        raise _wrong("cells", cells, "a positive whole number, or one for each axis")
    return {"cells": [int(n) for n in numbers] if isinstance(cells, Sequence) else int(cells)}


def _to_window(window: Sequence[Sequence[float]]) -> Settings:
    try:
        lower, upper = ([float(x) for x in corner] for corner in window)
    except (TypeError, ValueError):
        raise _wrong("window", window, "its lowest and its highest corner") from None
    if len(lower) != len(upper) or any(a >= b for a, b in zip(lower, upper, strict=True)):
        raise _wrong("window", window, "a highest corner above the lowest one along every axis")
    return {"lower": lower, "upper": upper}


def _to_target(betti: Betti) -> Settings:
    if isinstance(betti, (str, int)) or not 1 <= len(betti) <= 3:
        raise _wrong("betti", betti, "up to three Betti numbers, as (1, 0, 0)")
    target = {f"betti_{k}": _to_wanted(w) for k, w in enumerate(betti) if w is not None}
    if not target:
        raise _wrong("betti", betti, "at least one number that is not None")
    if find_empty(target):
        raise _wrong("betti", betti, "ranges whose min is not above their max")
    return target


def _to_wanted(wanted: Any) -> Wanted:
    """Return one entry of `betti` with plain integers."""
    if isinstance(wanted, Mapping) and set(wanted) <= {"min", "max"}:
        numbers = list(wanted.values())
    else:
        numbers = list(wanted) if isinstance(wanted, (list, tuple)) else [wanted]
    if not numbers or not all(_is_count(n) and n >= 0 for n in numbers):
        expected = 'a number from 0 on, a list of them, {"min": 1, "max": 3}, or None for any'
        raise _wrong("betti", wanted, expected)
    if isinstance(wanted, Mapping):
        return {key: int(n) for key, n in wanted.items()}
    return [int(n) for n in numbers] if isinstance(wanted, (list, tuple)) else int(wanted)


def _require_criteria(name: str, criteria: Any) -> None:
    _require_keys(name, criteria, list(_CRITERIA))
    for key, value in criteria.items():
        low, high, is_whole = _CRITERIA[key]
        is_right = _is_count(value) if is_whole else _is_number(value)
        if not is_right or not low <= value <= high:
            kind = "whole number" if is_whole else "number"
            end = "" if high == math.inf else f" to {high}"
            raise _wrong(f"{name}: {key}", value, f"a {kind} from {low}{end}")


def _require_keys(name: str, values: Any, allowed: Sequence[str]) -> None:
    if not isinstance(values, Mapping) or not set(values) <= set(allowed):
        raise _wrong(name, values, "a mapping with keys of " + ", ".join(allowed))


def _is_count(value: object) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool)


def _is_number(value: object) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)


def _wrong(name: str, found: object, expected: str) -> ConfigError:
    return ConfigError(
        f"found {found!r}",
        where=name,
        expected=expected,
        remedy="correct it; config/README.md explains every key",
    )
