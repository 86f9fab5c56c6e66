"""An extension of the reference: doctests at the end of a docstring are its examples."""

from __future__ import annotations

from typing import Any

import griffe

_HEADING = "\n\nExamples\n--------\n"


class Doctests(griffe.Extension):
    """Give doctests a heading where they have none, so that they are shown as code."""

    def on_object(self, *, obj: griffe.Object, **_: Any) -> None:
        """Change the docstring of every object that is read."""
        if obj.docstring is None or _HEADING in obj.docstring.value:
            return
        text, prompt, example = obj.docstring.value.partition("\n\n>>> ")
        if prompt:
            obj.docstring.value = f"{text}{_HEADING}>>> {example}"
