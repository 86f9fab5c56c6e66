"""Make one self-contained HTML page about a model."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import math
import re
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
import pandas as pd

from tusqh.antialias.cells import CellSets
from tusqh.explorer.arrays import (
    field_arrays,
    geometry_arrays,
    mesh_arrays,
    order_pairs,
    pair_arrays,
    plateau_arrays,
)
from tusqh.explorer.assets import FRAME, STYLE, TEMPLATE, read_asset, read_script, read_three
from tusqh.explorer.changes import changed_cells, offer_wishes
from tusqh.explorer.distances import FARTHEST, boundary_distances
from tusqh.explorer.encode import Packed, pack
from tusqh.explorer.subject import Subject
from tusqh.geometry.image import Image
from tusqh.grid import FloatArray
from tusqh.meshes.volume_mesh import KINDS
from tusqh.quality.verdict import overall
from tusqh.threshold.plateaus import BETTI
from tusqh.topology.persistence import place_pairs
from tusqh.topology.topology import Topology


def make_page(subject: Subject) -> str:
    """Return the explorer page of a model; the same subject gives the same text.

    Parameters
    ----------
    subject
        A model with its results.
    """
    grid = subject.fractions.grid
    cell_sets = CellSets(subject.fractions, subject.selection.policy)
    blocks = {
        "field": pack(field_arrays(subject.fractions)),
        "plateaus": pack(plateau_arrays(cell_sets, subject.curves, subject.topologies)),
        "pairs": pack(pair_arrays(subject.diagram, grid)),
        "mesh": pack(mesh_arrays(subject.mesh, grid, distances=_distances(subject))),
        "geometry": pack(geometry_arrays(subject.geometry, grid)),
    }
    changes, final = changed_cells(cell_sets, subject.selection, subject.mesh)
    topology = Topology.from_tables(
        subject.fractions.multiples, subject.curves, place_pairs(subject.diagram, grid)
    )
    cell_sets = CellSets(subject.fractions, subject.selection.policy, topology=topology)
    wishes, offers = offer_wishes(cell_sets, final["base"], order_pairs(subject.diagram))
    blocks |= {"changes": pack(changes), "wishes": pack(wishes)}
    facts = describe(subject) | {"up": subject.up, "final": final, "wishes": offers}
    return assemble(TEMPLATE, subject.name, facts, blocks, script=read_script())


def assemble(
    template: str, name: str, facts: dict[str, Any], blocks: Mapping[str, Packed], *, script: str
) -> str:
    """Return a page that holds everything it needs.

    Parameters
    ----------
    template
        Name of the template, see `tusqh.explorer.assets`.
    name
        Name of the model.
    facts
        Texts, numbers and tables of the page, as plain values.
    blocks
        Arrays of the page, by name.
    script
        The scripts of the page.
    """
    three = read_three()
    facts = facts | {"manifests": {key: packed.manifest for key, packed in blocks.items()}}
    payloads = "\n".join(
        f'<script type="text/plain" id="data-{key}">{packed.text}</script>'
        for key, packed in blocks.items()
    )
    return fill(
        read_asset(FRAME),
        body=read_asset(template),
        title=html.escape(f"{name} - tusqh explorer"),
        policy=_security_policy(three, script),
        style=read_asset(STYLE),
        facts=to_script_json(facts),
        payloads=payloads,
        three=three,
        script=script,
    )


def fill(template: str, **parts: str) -> str:
    """Return a template with each ``{{name}}`` replaced once; replacements are not expanded.

    Parameters
    ----------
    template
        Text with placeholders.
    **parts
        The replacement of each placeholder, by name.

    Examples
    --------
    >>> fill("{{a}} and {{b}}", a="{{b}}", b="c")
    '{{b}} and c'
    """
    return re.sub(r"\{\{(\w+)\}\}", lambda found: parts[found[1]], template)


def to_script_json(value: Any) -> str:
    r"""Return a value as JSON in which no text can end the enclosing script element.

    Parameters
    ----------
    value
        A value that JSON can represent, without NaN or infinity.

    Examples
    --------
    >>> to_script_json({"name": "</script><script>alert(1)"})
    '{"name":"\\u003c/script>\\u003cscript>alert(1)"}'
    """
    text = json.dumps(value, allow_nan=False, ensure_ascii=True, separators=(",", ":"))
    return text.replace("<", "\\u003c")


def describe(subject: Subject) -> dict[str, Any]:
    """Return the texts and tables of the page about a model, as plain values for JSON.

    Parameters
    ----------
    subject
        A model with its results.
    """
    grid, mesh, selection = subject.fractions.grid, subject.mesh, subject.selection
    betti = [getattr(selection.predicted, name) for name in BETTI[: grid.dim]]
    counts = np.bincount(mesh.kind, minlength=len(KINDS))
    return {
        "name": subject.name,
        "unit": subject.unit,
        "farthest": [FARTHEST, FARTHEST * grid.cell_size],
        "grid": grid.to_dict(),
        "chosen": {"threshold": selection.threshold, "reason": selection.reason},
        "verdict": overall(subject.tables["verdict"]),
        "command": asdict(subject.command),
        "head": [
            ["grid", f"{grid.label.replace('x', ' × ')} cells"],
            ["cell size", f"{grid.cell_size:.6g} {subject.unit}"],
            ["wanted", selection.wanted],
            ["chosen threshold", f"{selection.threshold:.6g} ± {selection.margin:.2g}"],
            *([["cells of the threshold", f"{selection.base:.6g}"]] if selection.base else []),
            ["mesh", f"{mesh.n_cells:,} {'hexes' if grid.dim == 3 else 'quads'}"],
            ["its Betti numbers", ", ".join(map(str, betti))],
        ],
        "kinds": [
            {"name": KINDS[kind], "index": int(kind), "count": int(counts[kind])}
            for kind in np.flatnonzero(counts)
        ],
        "has_removed": bool((subject.topologies["removed"] > 0).any()),
        "has_filled": bool((subject.topologies["filled"] > 0).any()),
        "tables": {
            name: to_rows(table.drop(columns="material", errors="ignore"))
            for name, table in subject.tables.items()
        },
    }


def _distances(subject: Subject) -> FloatArray | None:
    """Return the distances of a fitted boundary, None where the page does not show them."""
    if not subject.is_fitted or isinstance(subject.geometry, Image):
        return None
    return boundary_distances(subject.mesh, subject.geometry, subject.fractions.grid)


def to_rows(table: pd.DataFrame) -> dict[str, Any]:
    """Return a table as plain values: its columns and its rows.

    Parameters
    ----------
    table
        The table; numbers that are not finite become texts, missing ones null.
    """
    rows = [[_plain(value) for value in row] for row in table.itertuples(index=False)]
    return {"columns": [str(column) for column in table.columns], "rows": rows}


def _plain(value: Any) -> Any:
    value = value.item() if isinstance(value, np.generic) else value
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value if isinstance(value, (bool, int, float, str)) else None


def _security_policy(*scripts: str) -> str:
    """Return a policy that lets a page run only these scripts and load no resources."""
    digests = [base64.b64encode(hashlib.sha256(s.encode()).digest()).decode() for s in scripts]
    allowed = " ".join(f"'sha256-{digest}'" for digest in digests)
    return f"default-src 'none'; script-src {allowed}; style-src 'unsafe-inline'; base-uri 'none'"
