"""Add a model to the configuration and to the register, and copy its geometry file."""

from __future__ import annotations

import csv
import io
import shutil
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import yaml

from tusqh.atomic import replacing
from tusqh.errors import ConfigError
from tusqh.geometry.packaged import PACKAGE, locate
from tusqh.hashing import hash_file
from tusqh.pipeline.ingest import describe_geometry, ingest
from tusqh.settings.load import load_config, read_yaml
from tusqh.settings.model import Model

REGISTER = Path("data_sources/register.csv")

#: Counts of `describe` that are not defects.
_NO_DEFECTS = {
    *("triangles", "parts", "shells", "segments", "chains", "closed_chains", "points"),
    *("counter_clockwise_chains", "clockwise_chains", "signed_area", "signed_volume"),
    *("winding_number_min", "winding_number_max", "cap"),
    *("voxels", "material_voxels", "partial_voxels"),
}


def add_model(
    config_file: Path,
    name: str,
    model: Model,
    *,
    licence: str = "unknown",
    origin: str = "",
    url: str = "",
) -> tuple[str, dict[str, str]]:
    """Write a new model into both the configuration and the register, or into neither.

    A geometry file from outside the repository is copied to ``data_sources/<name>/``.  The text
    of the configuration does not change, comments included; the block is added after the last one.

    Parameters
    ----------
    config_file
        The configuration, in the folder ``config`` of the repository.
    name
        The name of the model.
    model
        Its settings, with one geometry file; those that are not the defaults, and the grid, become
        its block.
    licence, origin, url
        The licence and the origin of the file, for the register.

    Returns
    -------
    block
        The text that was added to the configuration.
    row
        The row that was added to the register.

    Raises
    ------
    ConfigError
        The name or an equal block exists already, or the block is not valid.
    GeometryError
        The file cannot be read (dirty geometry can be read).
    OutputError
        A file cannot be written.
    """
    root = config_file.resolve().parent.parent
    (geometry,) = model.files
    source, options = locate(geometry), model.settings
    defects = describe_geometry(
        ingest(geometry, image=options.image.to_dict(), lengths=options.lengths)
    )
    file = _file_in(root, name, geometry, source)
    entry = _to_entry(replace(model, geometry=file))
    before = read_yaml(config_file)
    _require_new(before.get("models", {}), name, entry, where=str(config_file))
    block, text = _insert(config_file, name, entry)
    _require_valid(config_file, text, {**before, "models": {**before["models"], name: entry}})
    row = {
        "model": name,
        "file": file,
        "available": "yes",
        "origin": origin or f"added from {source.name}",
        "url": url,
        "licence": licence,
        "sha256": hash_file(source),
        "known_defects": _in_words(defects),
    }
    register = _with_row(root / REGISTER, row)
    with ExitStack() as files:
        # The configuration, entered first, is renamed last: a model in it is always complete.
        files.enter_context(replacing(config_file)).write_bytes(text.encode())
        files.enter_context(replacing(root / REGISTER)).write_bytes(register.encode())
        if not file.startswith(PACKAGE) and not (root / file).exists():
            shutil.copyfile(source, files.enter_context(replacing(root / file)))
    return block, row


def _to_entry(model: Model) -> dict[str, Any]:
    """Return the block of a model: where its grid lies, and the settings that are not defaults.

    >>> _to_entry(Model.from_dict({"geometry": "a.stl", "unit": "mm"}))
    {'geometry': 'a.stl', 'grid': {'cells': 64, 'placement': 'auto'}, 'unit': 'mm'}
    """
    known = model.to_dict()
    changed = model.to_dict(defaults=False)
    grid = {key: value for key, value in known["grid"].items() if value is not False}
    entry = known | {"grid": grid}
    return {key: changed.get(key, entry[key]) for key in known if key in {*changed, "grid"}}


def _file_in(root: Path, name: str, geometry: str, source: Path) -> str:
    """Return how the configuration names the file: relative to the repository."""
    if geometry.startswith(PACKAGE):
        return geometry
    path = source.resolve()
    if path.is_relative_to(root):
        return path.relative_to(root).as_posix()
    target = Path("data_sources") / name / source.name
    if (root / target).exists() and hash_file(root / target) != hash_file(source):
        raise ConfigError(
            "another file of that name exists already",
            where=str(root / target),
            expected="a new file, or the same one",
            remedy="choose another --name, or rename the file",
        )
    return target.as_posix()


def _require_new(models: dict[str, Any], name: str, entry: dict[str, Any], *, where: str) -> None:
    for other, block in models.items():
        if other.lower() == name.lower() or block == entry:
            same = "name" if other.lower() == name.lower() else "block"
            raise ConfigError(
                f"the model {other!r} has the same {same}",
                where=f"{where}: models",
                expected="a new model",
                remedy=f"choose another --name, or remove {other!r} first",
            )


def _insert(config_file: Path, name: str, entry: dict[str, Any]) -> tuple[str, str]:
    """Return the text of a block, and the whole text with the block after the last model."""
    text = config_file.read_text(encoding="utf-8")
    document = yaml.compose(text)
    assert isinstance(document, yaml.MappingNode)  # `read_yaml` made sure.
    models = next((value for key, value in document.value if key.value == "models"), None)
    if not isinstance(models, yaml.MappingNode) or models.flow_style or not models.value:
        raise ConfigError(
            "`models:` is not a list of indented blocks",
            where=str(config_file),
            expected="one indented block per model",
            remedy="write the first model by hand; config/README.md shows how",
        )
    indent = " " * models.value[0][0].start_mark.column
    lines = [f"{indent}{name}:"] + [
        f"{indent}  {key}: {_to_yaml(value)}" for key, value in entry.items()
    ]
    block = "\n".join(lines) + "\n"
    before, after = _split_after(document, text)
    return block, f"{before}\n{block}{after}"


def _split_after(document: yaml.MappingNode, text: str) -> tuple[str, str]:
    """Return the text up to the end of the models, and the rest: comments and other keys."""
    keys = [key for key, _ in document.value]
    following = [k.start_mark.index for k in keys[[k.value for k in keys].index("models") + 1 :]]
    end = following[0] if following else len(text)
    lines = text[:end].splitlines(keepends=True)
    n_kept = len(lines)
    while not lines[n_kept - 1].strip() or (following and lines[n_kept - 1].startswith("#")):
        n_kept -= 1
    before = "".join(lines[:n_kept])
    rest = "".join(lines[n_kept:]) + text[end:]
    return before if before.endswith("\n") else before + "\n", rest


def _to_yaml(value: Any) -> str:
    text = yaml.safe_dump(value, default_flow_style=True, width=1000, allow_unicode=True)
    return str(text).removesuffix("\n").removesuffix("\n...")


def _require_valid(config_file: Path, text: str, expected: dict[str, Any]) -> None:
    """Raise unless the new text contains the expected model and follows the schema."""
    if yaml.safe_load(text) != expected:
        raise ConfigError(
            "the block cannot be added without changing others",
            where=str(config_file),
            expected="one indented block per model",
            remedy="add it by hand; config/README.md shows how",
        )
    load_config([config_file], expected)


def _with_row(register: Path, row: dict[str, str]) -> str:
    """Return the text of the register with one more row."""
    text = register.read_text(encoding="utf-8") if register.is_file() else ""
    rows = list(csv.DictReader(io.StringIO(text)))
    same = [other for other in rows if other["model"] == row["model"]]
    if same:
        raise ConfigError(
            f"the model {row['model']!r} has a row already",
            where=str(register),
            expected="a new model",
            remedy="choose another --name, or remove the row first",
        )
    out = io.StringIO()
    writer = csv.DictWriter(out, row, lineterminator="\n")
    if not text:
        writer.writeheader()
    writer.writerow(row)
    return text + ("" if text.endswith("\n") or not text else "\n") + out.getvalue()


def _in_words(defects: Any) -> str:
    """Return the defects that were found, in words."""
    found = [
        f"{row.count} {row.defect.replace('_', ' ')}"
        for row in defects.itertuples(index=False)
        if row.count > 0 and row.defect not in _NO_DEFECTS
    ]
    return ", ".join(found) or "none found"
