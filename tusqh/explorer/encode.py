"""Encode arrays as text for a page (gzip in base64); equal arrays give equal bytes."""

from __future__ import annotations

import base64
import gzip
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: Types for which browsers have typed arrays.
TYPES = ("uint8", "int8", "uint16", "uint32", "int32", "float32")


@dataclass(frozen=True)
class Packed:
    """Arrays in one compressed block.

    Parameters
    ----------
    manifest
        The position of each array: `name`, `type` (one of `TYPES`), `offset` in bytes, `length`.
    text
        The block: little-endian, with each array at a multiple of 4 bytes, as gzip in base64.
    """

    manifest: list[dict[str, Any]]
    text: str


def pack(arrays: Mapping[str, NDArray[Any]]) -> Packed:
    """Return arrays, flattened in C order, as one block of text.

    Parameters
    ----------
    arrays
        Arrays of any shape by name, each of one of the `TYPES`.

    Raises
    ------
    ValueError
        An array has a type that browsers do not have.

    Examples
    --------
    >>> packed = pack({"shape": np.array([60, 79], dtype=np.uint32)})
    >>> packed.manifest
    [{'name': 'shape', 'type': 'uint32', 'offset': 0, 'length': 2}]
    >>> gzip.decompress(base64.b64decode(packed.text)).hex()
    '3c0000004f000000'
    """
    manifest: list[dict[str, Any]] = []
    block = bytearray()
    for name, array in arrays.items():
        if array.dtype.name not in TYPES:
            raise ValueError(f"{name} is {array.dtype.name}, not one of {', '.join(TYPES)}")
        block += bytes(-len(block) % 4)
        entry = {"name": name, "type": array.dtype.name, "offset": len(block), "length": array.size}
        manifest.append(entry)
        block += array.astype(array.dtype.newbyteorder("<"), copy=False).tobytes()
    compressed = gzip.compress(bytes(block), compresslevel=9, mtime=0)
    return Packed(manifest, base64.b64encode(compressed).decode("ascii"))


def smallest_unsigned(array: NDArray[Any]) -> NDArray[Any]:
    """Return non-negative integers in the smallest unsigned type that holds them.

    Parameters
    ----------
    array
        Non-negative integers, of any shape.

    Examples
    --------
    >>> smallest_unsigned(np.array([0, 300])).dtype.name
    'uint16'
    """
    top = int(array.max(initial=0))
    return array.astype(np.uint8 if top < 2**8 else np.uint16 if top < 2**16 else np.uint32)
