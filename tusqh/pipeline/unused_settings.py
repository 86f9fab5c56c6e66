"""Add remarks on settings that have no effect on a geometry."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from tusqh.geometry.kinds import kind_of
from tusqh.geometry.remark import Remark
from tusqh.pipeline.ingest import read_source
from tusqh.readers.reading import Reading
from tusqh.settings.effect import find_without_effect
from tusqh.settings.model import Settings


def read_with(source: Any, settings: Settings, *, name: str = "geometry") -> Reading:
    """Return the reading of a source with the settings for it, and remarks on unused settings.

    Parameters
    ----------
    source
        The geometry, see `tusqh.pipeline.ingest.ingest`.
    settings
        The given settings.
    name
        Name, in messages, of a geometry from memory.
    """
    image, lengths = settings.image.to_dict(), settings.lengths
    reading = read_source(source, name=name, image=image, lengths=lengths)
    return note_unused_settings(reading, settings)


def note_unused_settings(reading: Reading, settings: Settings) -> Reading:
    """Return a reading with a remark for each setting that has no effect on its geometry.

    Parameters
    ----------
    reading
        The geometry, and the remarks of the reader.
    settings
        The given settings.
    """
    return with_unused(reading, find_without_effect(settings, kind_of(reading.geometry)))


def with_unused(reading: Reading, unused: Iterable[str]) -> Reading:
    """Return a reading with a remark for each sentence on a setting without an effect.

    Parameters
    ----------
    reading
        The geometry, and the remarks of the reader.
    unused
        Sentences of `tusqh.settings.effect.find_without_effect`.
    """
    found = [Remark("noted", f"setting without effect: {text}", 1, "remove it") for text in unused]
    return replace(reading, remarks=(*reading.remarks, *found))
