"""Extend the reference: turn doctests into examples, and names of tusqh into links."""

from __future__ import annotations

import re
from typing import Any

import griffe

_HEADING = "\n\nExamples\n--------\n"

#: A name of the library in back-ticks.  The strict build fails if such a link leads nowhere.
_NAME = re.compile(r"(?<!\[)`(tusqh(?:\.\w+)+)`")


class Docstrings(griffe.Extension):
    """Prepare the docstring of every object for the reference."""

    def on_object(self, *, obj: griffe.Object, **_: Any) -> None:
        """Give doctests at the end of a docstring a heading, and link names of the library."""
        if obj.docstring is None:
            return
        text = _NAME.sub(r"[`\1`][\1]", obj.docstring.value)
        if isinstance(obj, griffe.Class) and "NamedTuple" in map(str, obj.bases):
            # A tuple has no signature of its own in which its fields could be found.
            text = text.replace("Parameters\n----------\n", "Attributes\n----------\n")
        body, prompt, example = text.partition("\n\n>>> ")
        if prompt and _HEADING not in text:
            text = f"{body}{_HEADING}>>> {example}"
        obj.docstring.value = text
