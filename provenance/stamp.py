"""The mark in a figure's own metadata that says which step drew it, and of what.

A picture found on a slide leads back to its sources by it: see `tusqh trace`.
"""

from __future__ import annotations

import json
import re
import struct
import zlib
from pathlib import Path
from typing import Any

from tusqh.atomic import replacing
from tusqh.hashing import hash_value

#: Formats that have room for a mark.
MARKED = (".png", ".svg", ".pdf")

_KEYWORD = b"tusqh-source"
_PNG = b"\x89PNG\r\n\x1a\n"
#: Where the first chunk of every PNG file, its header of fixed size, ends.
_AFTER_HEADER = len(_PNG) + 25
_COMMENT = re.compile(rb"\n?(?:<!--|%) tusqh-source (\{.*?\})(?: -->)?\n")


def source_mark(what: dict[str, Any], path: str) -> dict[str, Any]:
    """Return the mark of a step's figure: file, step, model, digest of all it was drawn from.

    The digest covers the inputs and parameters, not the code, so that equal pictures stay equal
    files when code changes.
    """
    source = {key: what[key] for key in ("step", "model", "parameters", "inputs")}
    return {key: what[key] for key in ("step", "model")} | {
        "file": path,
        "sha256": hash_value(source),
    }


def stamp(path: Path, mark: dict[str, Any]) -> None:
    """Write a mark into a PNG, SVG or PDF file, in place of an older one; whole or not at all."""
    content = path.read_bytes()
    text = json.dumps(mark, sort_keys=True).encode()
    if content.startswith(_PNG):
        kept = b"".join(data for keyword, data in _chunks(content) if keyword != _KEYWORD)
        head, tail = kept[: _AFTER_HEADER - len(_PNG)], kept[_AFTER_HEADER - len(_PNG) :]
        content = _PNG + head + _text_chunk(text) + tail
    elif path.suffix == ".svg":
        content = _COMMENT.sub(b"", content) + b"\n<!-- tusqh-source " + text + b" -->\n"
    else:
        content = _COMMENT.sub(b"", content) + b"\n% tusqh-source " + text + b"\n"
    with replacing(path) as temporary:
        temporary.write_bytes(content)


def read_mark(path: Path) -> dict[str, Any] | None:
    """Return the mark in a figure, or None where there is none."""
    content = path.read_bytes()
    if content.startswith(_PNG):
        found = [data[8:-4] for keyword, data in _chunks(content) if keyword == _KEYWORD]
        texts = [data.partition(b"\0")[2] for data in found]
    else:
        texts = _COMMENT.findall(content)
    try:
        return dict(json.loads(texts[0])) if texts else None
    except (ValueError, TypeError):
        return None


def _chunks(content: bytes) -> list[tuple[bytes, bytes]]:
    """Return the chunks of a PNG file, whole, with the keyword of those that are text."""
    chunks = []
    start = len(_PNG)
    while start + 12 <= len(content):
        (size,) = struct.unpack(">I", content[start : start + 4])
        chunk = content[start : start + 12 + size]
        keyword = chunk[8:-4].partition(b"\0")[0] if chunk[4:8] == b"tEXt" else b""
        chunks.append((keyword, chunk))
        start += 12 + size
    return chunks


def _text_chunk(text: bytes) -> bytes:
    data = b"tEXt" + _KEYWORD + b"\0" + text
    return struct.pack(">I", len(data) - 4) + data + struct.pack(">I", zlib.crc32(data))
