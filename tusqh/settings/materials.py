"""The materials of a mesh: their names, where each comes from, and what is wished of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from tusqh.settings.field import setting
from tusqh.settings.goal import Target
from tusqh.settings.section import Section
from tusqh.settings.validate import Path, refuse


@dataclass(frozen=True)
class Material(Section):
    """A material: a file, a part of a file, or a label of an image; at most one wish.

    Examples
    --------
    >>> Material.from_dict({"name": "ring", "source": "ring.stl", "threshold": 0.4}).threshold
    0.4
    """

    title: ClassVar[str] = "Materials"

    name: str = setting("Name of the material.", extra={"minLength": 1})
    source: str | None = setting(
        "Geometry file of the material.", default=None, otherwise="the `geometry` of the model"
    )
    part: int | None = setting(
        "Number of the part of that file, from 1: a solid, object, node or feature of the file; if "
        "there is only one, a connected piece.",
        default=None,
        otherwise="all parts",
        at_least=1,
    )
    label: int | None = setting(
        "Label of the material, in an image of labels.", default=None, otherwise="none"
    )
    threshold: float | None = setting(
        "A cell takes the material with the largest ratio of fraction to threshold. A material "
        "called `void` stands for the region outside all others.",
        default=None,
        otherwise="1",
        above=0,
        at_most=1,
    )
    target: Target | None = setting(
        "Betti numbers that the material must have; its threshold is chosen accordingly.",
        default=None,
        otherwise="any",
    )
    diffusivity: float | None = setting(
        "Diffusivity of the material in the simulation.",
        default=None,
        otherwise="that of `simulation`",
        unit="m^2/s",
        above=0,
    )

    def find_contradictions(self) -> Iterator[tuple[Path, str, str]]:
        """Yield a threshold beside a target, and a part beside a label."""
        yield from super().find_contradictions()
        for first, second in (("threshold", "target"), ("part", "label"), ("source", "label")):
            if getattr(self, first) is not None and getattr(self, second) is not None:
                yield (first,), f"`{second}` is given too", "one of the two"


#: How the materials of a mesh may be given in Python.
Materials = Mapping[Any, Any] | Sequence[Any] | str


def to_materials(given: Materials) -> tuple[Material, ...]:
    """Return the materials that a value of the argument `materials` describes.

    Parameters
    ----------
    given
        A list of `Material` or of mappings with its keys; or a mapping from labels (integers) to
        names, or from names to a threshold, to Betti numbers, or to a mapping with those keys;
        ``"parts"`` for every part of the geometry; ``"labels"`` for every label of an image.

    Returns
    -------
    materials
        In the given order; none for ``"parts"`` and ``"labels"``.

    Raises
    ------
    ConfigError
        A value is of another kind or out of range, or two materials have one name.

    Examples
    --------
    >>> [m.to_dict(defaults=False) for m in to_materials({1: "bone", 2: "marrow"})]
    [{'name': 'bone', 'label': 1}, {'name': 'marrow', 'label': 2}]
    >>> [m.to_dict(defaults=False) for m in to_materials({"ring": 0.4, "ball": (1, 0)})]
    [{'name': 'ring', 'threshold': 0.4}, {'name': 'ball', 'target': {'betti_0': 1, 'betti_1': 0}}]
    """
    if isinstance(given, str):
        if given in ("parts", "labels"):
            return ()
        raise refuse("materials", f"found {given!r}", "`parts`, `labels`, a list or a mapping")
    entries: Iterable[Any] = given
    if isinstance(given, Mapping):
        entries = [_from_pair(key, value) for key, value in given.items()]
    materials = tuple(
        m if isinstance(m, Material) else Material.from_dict(m, locate=_locate(k))
        for k, m in enumerate(entries)
    )
    for path, found, expected in find_repeated(materials):
        raise refuse(_locate(int(path[0]))(()), found, expected)
    return materials


def find_repeated(materials: Sequence[Material]) -> Iterator[tuple[Path, str, str]]:
    """Yield the materials whose name or label an earlier one has.

    Parameters
    ----------
    materials
        The materials.
    """
    for k, material in enumerate(materials):
        earlier = materials[:k]
        if material.name in [m.name for m in earlier]:
            yield (k, "name"), f"found {material.name!r} again", "a name for each material"
        if material.label is not None and material.label in [m.label for m in earlier]:
            yield (k, "label"), f"found {material.label} again", "a label for each material"


def _from_pair(key: Any, value: Any) -> dict[str, Any]:
    """Return the keys of a material that an entry of a mapping describes."""
    if isinstance(key, str):
        if isinstance(value, Mapping):
            return {"name": key, **value}
        if isinstance(value, Sequence) and not isinstance(value, str):
            return {"name": key, "target": Target.from_argument(value)}
        return {"name": key, "threshold": value}
    if isinstance(value, Mapping):
        return {"label": key, **value}
    return {"label": key, "name": value}


def _locate(number: int) -> Any:
    """Return a function that names the place of a value in the materials."""
    return lambda path: ".".join(map(str, ("materials", number, *path)))
