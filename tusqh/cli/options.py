"""Options of the command line that are made from the fields of the settings."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Mapping
from dataclasses import MISSING
from typing import Annotated, Any, get_type_hints

import typer
from typer.core import TyperCommand

from tusqh.readers import formats
from tusqh.settings.arguments import Argument, from_options, options_of
from tusqh.settings.model import Settings
from tusqh.settings.validate import refuse_unknown

#: What a geometry argument may be: the formats of outlines, surfaces, images and pictures.
FORMATS = "; ".join(
    ", ".join(found.name for found in formats.FORMATS if found.kind == kind)
    for kind in ("outline", "surface", "image", "picture")
)

Source = Annotated[
    str, typer.Argument(metavar="GEOMETRY", help=f"{FORMATS}; or package:NAME/FILE.")
]

Sources = Annotated[
    list[str],
    typer.Argument(
        metavar="GEOMETRY...",
        help=f"{FORMATS}; or package:NAME/FILE. With --materials, several files.",
    ),
]


class Command(TyperCommand):
    """A command that names the nearest option where one is unknown."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the words of the command line.

        Parameters
        ----------
        ctx
            The context of the command.
        args
            The words.

        Returns
        -------
        words
            The words that are not options.

        Raises
        ------
        ConfigError
            An option does not exist.
        """
        allowed = [name for p in self.get_params(ctx) for name in (*p.opts, *p.secondary_opts)]
        words = args[: args.index("--")] if "--" in args else args
        for name in (word.partition("=")[0] for word in words if word.startswith("--")):
            if name not in allowed:
                long_names = [other for other in allowed if other.startswith("--")]
                raise refuse_unknown(f"tusqh {self.name}", name, long_names, kind="option")
        return list(super().parse_args(ctx, args))


def with_settings(*, without: tuple[str, ...] = ()) -> Callable[[Any], Any]:
    """Return a decorator that gives a command an option for each field of the settings.

    Parameters
    ----------
    without
        Fields of `Settings` that the command has no options for, as ``goal`` or ``goal.target``.

    Returns
    -------
    decorator
        It replaces the parameter `settings` of a command.
    """
    return functools.partial(_add_options, without=without)


def _add_options(command: Any, *, without: tuple[str, ...]) -> Any:
    options = [
        o
        for o in options_of(Settings)
        if not {o.attributes[0], ".".join(o.attributes)}.intersection(without)
    ]
    hints = get_type_hints(command, include_extras=True)
    own = inspect.signature(command).parameters
    parameters = []
    for name, parameter in own.items():
        if name == "settings":
            parameters += [to_parameter(option) for option in options]
        else:
            parameters.append(
                parameter.replace(annotation=hints[name], kind=parameter.KEYWORD_ONLY)
            )

    @functools.wraps(command)
    def run(**values: Any) -> None:
        given: Mapping[str, Any] = {option.name: values.pop(option.name) for option in options}
        command(**values, settings=from_options(Settings, given))

    run.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    run.__annotations__ = {p.name: p.annotation for p in parameters}
    return run


def to_parameter(argument: Argument) -> inspect.Parameter:
    """Return the parameter of a typer command for a setting.

    Its value is text: `tusqh.settings.arguments.from_options` reads it, so that mistakes get the
    same message as in the configuration.

    Parameters
    ----------
    argument
        The setting.
    """
    about = argument.entry.setting
    unit = f" Unit: {about.unit}." if about.unit else ""
    form = " May be given several times." if argument.word else ""
    form = getattr(argument.kind, "option_form", form)
    owner = f"{argument.owner.capitalize()}: " if argument.owner else ""
    help_text = owner + about.sentence + form + unit + _default_in_words(argument)
    name, has_no_value = argument.option, argument.is_flag or argument.is_switch
    option = typer.Option(
        f"{name}/{name.replace('--', '--no-', 1)}" if argument.is_switch else name,
        help=help_text.replace("*", r"\*"),
        metavar=None if has_no_value else about.metavar or "|".join(argument.choices) or "X",
        rich_help_panel=f"{argument.title} options",
        show_default=False,
    )
    kind: Any = bool if argument.is_flag else bool | None if argument.is_switch else str | None
    if argument.word:
        kind = list[str] | None
    return inspect.Parameter(
        argument.name,
        inspect.Parameter.KEYWORD_ONLY,
        default=False if argument.is_flag else None,
        annotation=Annotated[kind, option],
    )


def _default_in_words(argument: Argument) -> str:
    default = argument.entry.default
    if default is MISSING or default is None:
        default = argument.entry.setting.otherwise
    return "" if default is None else f" (default: {default})"
