"""Convert settings to and from arguments of `tusqh.mesh` and options of the command line."""

from __future__ import annotations

import dataclasses
import functools
import inspect
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Literal, ParamSpec, TypeVar, get_args, get_origin

from tusqh.settings.field import Entry, entries_of
from tusqh.settings.schema import inner_type, schema_of
from tusqh.settings.section import Section
from tusqh.settings.validate import Locate, Path, from_text, refuse, refuse_unknown

P = ParamSpec("P")
R = TypeVar("R")
S = TypeVar("S", bound=Section)


@dataclasses.dataclass(frozen=True)
class Argument:
    """A setting, or a section with a single value, as an argument or an option.

    Parameters
    ----------
    name
        Name as an identifier, such as ``min_cells``.
    path
        Keys that lead to the setting in a block of the configuration.
    attributes
        Attributes that lead to the setting in the typed settings.
    entry
        The field.
    title
        Heading of the section.
    owner
        Name of the enclosing section if the setting's own name is ambiguous, such as
        ``components``.
    word
        The option if it adds an entry to a list, such as ``fill``; empty for other settings.
    """

    name: str
    path: Path
    attributes: tuple[str, ...]
    entry: Entry
    title: str
    owner: str
    word: str = ""

    @property
    def kind(self) -> Any:
        """The type of the value, without None."""
        return inner_type(self.entry.hint)

    @property
    def is_section(self) -> bool:
        """Whether the value is a whole section."""
        return _is_section(self.kind)

    @property
    def choices(self) -> tuple[str, ...]:
        """The allowed words; empty if the value is not one of a few words."""
        return get_args(self.kind) if get_origin(self.kind) is Literal else ()

    @property
    def is_flag(self) -> bool:
        """Whether the option takes no value, because only one value is possible."""
        return len(self.choices) == 1

    @property
    def is_switch(self) -> bool:
        """Whether the option switches something on, and ``--no-NAME`` switches it off."""
        return self.kind is bool

    @property
    def option(self) -> str:
        """The name on the command line."""
        given = self.word or self.entry.setting.option
        if given:
            return f"--{given}"
        words = f"{self.choices[0]}_{self.name}" if self.is_flag else self.name
        return "--" + words.replace("_", "-")

    def value_in(self, settings: Section) -> Any:
        """Return the value in typed settings.

        Parameters
        ----------
        settings
            The section that contains the argument.
        """
        return functools.reduce(getattr, self.attributes, settings)


def arguments_of(section: type[Section]) -> dict[str, Argument]:
    """Return the arguments of `tusqh.mesh` for a section, by name.

    Parameters
    ----------
    section
        The section.

    Examples
    --------
    >>> from tusqh.settings.model import Settings
    >>> list(arguments_of(Settings))[:3]
    ['cells', 'cell_size', 'placement']
    """
    found = _arguments(section, lambda entry: entry.setting.is_inline or entry.setting.is_spread)
    return {argument.name: argument for argument in found}


def options_of(section: type[Section]) -> list[Argument]:
    """Return the options of the command line for a section.

    Parameters
    ----------
    section
        The section.

    Examples
    --------
    >>> from tusqh.settings.voxels import Voxels
    >>> [argument.option for argument in options_of(Voxels)]
    ['--voxel-size', '--empty', '--full', '--labels', '--channel', '--voxels', '--voxel-order']
    """
    found = _arguments(section, lambda entry: not entry.setting.argument)
    return [option for argument in found for option in _by_word(argument)]


def _by_word(argument: Argument) -> list[Argument]:
    """Return the options of an argument: one, or one for each word that adds to a list."""
    words = argument.entry.setting.words
    return [dataclasses.replace(argument, name=w, word=w) for w in words] or [argument]


def from_arguments(section: type[S], values: Mapping[str, Any]) -> S:
    """Return the checked section that arguments of a Python call describe.

    Parameters
    ----------
    section
        The section.
    values
        The arguments by name; None for those that are not given.

    Raises
    ------
    ConfigError
        An argument is invalid; the message names it, the value found and the allowed values.

    Examples
    --------
    >>> from tusqh.settings.model import Settings
    >>> settings = from_arguments(Settings, {"cells": 32, "betti": (1, None, {"max": 2})})
    >>> settings.grid.cells, str(settings.goal.target)
    (32, 'betti_0 = 1, betti_2 <= 2')
    """
    arguments = arguments_of(section)
    block: dict[str, Any] = {}
    for name, value in values.items():
        if value is None:
            continue
        argument = arguments[name]
        if argument.entry.setting.argument:
            value = _read(argument.kind.from_argument, value, f"argument {name}")
        _put(block, argument.path, value)
    names = {argument.path: f"argument {name}" for name, argument in arguments.items()}
    return section.from_dict(block, locate=_locate_by(names))


def from_options(section: type[S], values: Mapping[str, Any]) -> S:
    """Return the checked section that options of the command line describe.

    Parameters
    ----------
    section
        The section.
    values
        The text of each option, by the names of `options_of`, a list of texts for one that may be
        given several times; whether a switch is on; None, and False for a flag, for those that are
        not given.

    Raises
    ------
    ConfigError
        An option is invalid; the message names it, the value found and the allowed values.

    Examples
    --------
    >>> from tusqh.settings.model import Settings
    >>> from_options(Settings, {"cells": "60,79", "volume": True}).grid.cells
    (60, 79)
    """
    options = {argument.name: argument for argument in options_of(section)}
    kind: type = section
    schema = schema_of(kind)
    block: dict[str, Any] = {}
    for name, text in values.items():
        argument, value = options[name], text
        if text is None or (text is False and not argument.is_switch):
            continue
        if argument.word:
            convert = functools.partial(get_args(argument.kind)[0].from_option, argument.word)
            value = block.get(argument.entry.name, [])
            value = [*value, *(_read(convert, t, f"option {argument.option}") for t in text)]
        elif argument.is_flag:
            value = argument.choices[0]
        elif argument.is_section:
            value = _read(argument.kind.from_option, text, f"option {argument.option}")
        _put(block, argument.path, value)
    names: dict[Path, str] = {}
    for argument in options.values():
        before = names.get(argument.path)
        names[argument.path] = (f"{before} or " if before else "option ") + argument.option
    block = from_text(block, schema, schema.get("$defs", {}))
    return section.from_dict(block, locate=_locate_by(names))


def to_words(settings: Section, *, without: tuple[str, ...] = ()) -> list[str]:
    """Return the words of the command line for settings that differ from the defaults.

    Parameters
    ----------
    settings
        The settings.
    without
        Fields of the settings that are left out.

    Examples
    --------
    >>> from tusqh.settings.model import Settings
    >>> to_words(Settings.from_dict({"rule": "clamped", "components": {"min_cells": 4}}))
    ['--rule', 'clamped', '--min-cells', '4']
    """
    words: list[str] = []
    defaults = type(settings)()
    for argument in options_of(type(settings)):
        value = argument.value_in(settings)
        is_default = argument.attributes[0] in without or value == argument.value_in(defaults)
        if value is None or is_default:
            continue
        if argument.word:
            chosen = [entry.to_option() for entry in value if entry.do == argument.word]
            words += [f"{argument.option}={text}" for text in chosen]
            continue
        text = value.to_option() if argument.is_section else _to_text(value)
        if argument.is_flag or argument.is_switch:
            words.append(argument.option if value else argument.option.replace("--", "--no-", 1))
        elif text.startswith("-"):
            words.append(f"{argument.option}={text}")
        else:
            words += [argument.option, text]
    return words


def explains_unknown_arguments(function: Callable[P, R]) -> Callable[P, R]:
    """Return a function that, for an unknown argument, names the nearest known one.

    Parameters
    ----------
    function
        The function; its argument `source` is not a setting.

    Raises
    ------
    ConfigError
        The returned function raises it if an argument is unknown.
    """
    names = [name for name in inspect.signature(function).parameters if name != "source"]

    @functools.wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> R:
        for name in kwargs:
            if name != "source" and name not in names:
                where = f"tusqh.{function.__name__}"
                raise refuse_unknown(where, name, names, kind="argument")
        return function(*args, **kwargs)

    return checked


def _arguments(
    section: type,
    is_opened: Callable[[Entry], bool],
    above: Argument | None = None,
    prefix: str = "",
) -> Iterator[Argument]:
    """Yield the settings of a section and of its opened subsections."""
    path, attributes = (above.path, above.attributes) if above else ((), ())
    for entry in entries_of(section):
        about = entry.setting
        kind = inner_type(entry.hint)
        name = (prefix + (about.argument or entry.name)).replace("-", "_")
        step: Path = () if about.is_inline else (entry.name,)
        title = getattr(section, "title", "") or getattr(kind, "title", "")
        outer = above.entry.setting if above else about
        owner = above.entry.name if above and not (outer.is_inline or outer.is_spread) else ""
        found = Argument(name, (*path, *step), (*attributes, entry.name), entry, title, owner)
        if _is_section(kind) and is_opened(entry):
            yield from _arguments(kind, is_opened, found, prefix + about.prefix)
        else:
            yield found


def _is_section(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, Section)


def _read(convert: Callable[[Any], Any], value: Any, where: str) -> Any:
    """Convert a value to a mapping, or raise an error that states what is expected."""
    try:
        return convert(value)
    except ValueError as expected:
        raise refuse(where, f"found {value!r}", str(expected)) from None


def _put(block: dict[str, Any], path: Path, value: Any) -> None:
    for key in path[:-1]:
        block = block.setdefault(str(key), {})
    block[str(path[-1])] = value


def _locate_by(names: Mapping[Path, str]) -> Locate:
    """Return a function that names the option or argument of the value at a path."""

    def locate(path: Path) -> str:
        for k in range(len(path), 0, -1):
            if path[:k] in names:
                return ", ".join([names[path[:k]], *map(str, path[k:])])
        return ".".join(map(str, path)) or "settings"

    return locate


def _to_text(value: Any) -> str:
    if isinstance(value, tuple):
        return ",".join(map(_to_text, value))
    return repr(value).removesuffix(".0") if isinstance(value, float) else str(value)
