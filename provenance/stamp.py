"""The mark in the metadata of a figure, which identifies the step and the sources that made it.

A figure found on a slide leads back to its sources, see `tusqh trace`.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from PIL import Image, PngImagePlugin, UnidentifiedImageError

from tusqh.atomic import replacing
from tusqh.hashing import hash_value

#: Formats whose metadata can contain a mark.
MARKED = (".png", ".svg", ".pdf")

_KEYWORD = "tusqh-source"
_PNG = b"\x89PNG\r\n\x1a\n"
_COMMENT = re.compile(rb"\n?(?:<!--|%) tusqh-source (\{.*?\})(?: -->)?\n")


def source_mark(what: dict[str, Any], path: str) -> dict[str, Any]:
    """Return the mark of a figure: file, step, model, and a digest of inputs and parameters.

    The digest omits the code, so that equal pictures remain equal files if code changes.

    Parameters
    ----------
    what
        The `what` part of the step's record, with or without the outputs.
    path
        The figure.
    """
    source = {key: what[key] for key in ("step", "model", "parameters", "inputs")}
    return {
        "step": what["step"],
        "model": what["model"],
        "file": path,
        "sha256": hash_value(source),
    }


def stamp(path: Path, mark: dict[str, Any]) -> None:
    """Write a mark into a PNG, SVG or PDF file, replacing an older mark; never write half a file.

    Parameters
    ----------
    path
        The figure.
    mark
        The mark, see `source_mark`.
    """
    text = json.dumps(mark, sort_keys=True)
    with replacing(path) as temporary:
        if _is_png(path):
            _stamp_png(path, text, temporary)
            return
        content = _COMMENT.sub(b"", path.read_bytes())
        opening, closing = (b"<!--", b" -->") if path.suffix == ".svg" else (b"%", b"")
        comment = b"\n%b tusqh-source %b%b\n" % (opening, text.encode(), closing)
        temporary.write_bytes(content + comment)


def read_mark(path: Path) -> dict[str, Any] | None:
    """Return the mark in a figure, or None if it has none.

    Parameters
    ----------
    path
        The figure.
    """
    try:
        if _is_png(path):
            with Image.open(path) as image:
                text = image.info.get(_KEYWORD, "")
        else:
            text = b"".join(_COMMENT.findall(path.read_bytes())[:1])
        return dict(json.loads(text)) if text else None
    except (UnidentifiedImageError, ValueError, TypeError):
        return None


def _is_png(path: Path) -> bool:
    with path.open("rb") as stream:
        return stream.read(len(_PNG)) == _PNG


def _stamp_png(path: Path, text: str, target: Path) -> None:
    """Write a copy of a PNG file with the mark, keeping its other texts and its resolution."""
    with Image.open(path) as image:
        image.load()
        texts = PngImagePlugin.PngInfo()
        for keyword, value in image.info.items():
            if isinstance(keyword, str) and isinstance(value, str) and keyword != _KEYWORD:
                texts.add_text(keyword, value)
        texts.add_text(_KEYWORD, text)
        options = {"dpi": image.info["dpi"]} if "dpi" in image.info else {}
        image.save(target, format="PNG", pnginfo=texts, **options)
