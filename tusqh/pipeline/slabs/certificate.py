"""The certificate of a mesh in slabs, and its check from the files of the pieces."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from tusqh.atomic import replacing, write_text
from tusqh.certificate import claim_of_cells, claims_of_mesh, compare_claims
from tusqh.errors import MeshError
from tusqh.grid import BackgroundGrid, BoolArray
from tusqh.grid.slabs import Slab
from tusqh.hashing import canonical_json, hash_file
from tusqh.meshes.checks import Check
from tusqh.meshes.measure_pieces import PiecesMeasurement
from tusqh.meshes.piece_files import pieces_in
from tusqh.meshes.seams import Piece
from tusqh.meshes.volume_mesh import GRID_CELL, INNER_CELL
from tusqh.pipeline.slabs.cells import SlabCells
from tusqh.pipeline.slabs.fractions import SlabFractions, Survey
from tusqh.sampling.io import load_fractions

#: The file that names the fractions of the slabs, and their folder.
FRACTIONS, FRACTIONS_FOLDER = "fractions.json", "fractions_pieces"


def write_fractions(folder: Path, fractions: SlabFractions) -> Path:
    """Write the fractions of all slabs beside a mesh.

    Parameters
    ----------
    folder
        The folder of the mesh.
    fractions
        The fractions.

    Returns
    -------
    path
        The file that names them.
    """
    rows = []
    for slab in fractions.slabs:
        fractions.multiples(slab)  # Makes the file if it is not there.
        target = folder / FRACTIONS_FOLDER / f"{slab.number:04d}.npz"
        source = fractions.folder.name("fractions", fractions.digest, slab.number)
        if source != target:  # The workflow makes them at their place.
            with replacing(target) as temporary:
                shutil.copyfile(source, temporary)
        rows.append(
            {"begin": slab.begin, "end": slab.end, "file": f"{FRACTIONS_FOLDER}/{target.name}"}
        )
    content = {
        "grid": fractions.grid.to_dict(),
        "samples": fractions.samples,
        "slabs": rows,
    }
    write_text(folder / FRACTIONS, canonical_json(content))
    return folder / FRACTIONS


def digests(mesh: Path, fractions: Path) -> dict[str, dict[str, Any]]:
    """Return names and digests of a mesh in pieces and of its fractions.

    Parameters
    ----------
    mesh
        The PVTU file.
    fractions
        The file of `write_fractions`.
    """
    slabs = json.loads(fractions.read_text("utf-8"))["slabs"]
    pieces = {mesh: pieces_in(mesh), fractions: [fractions.parent / s["file"] for s in slabs]}
    return {
        key: {
            "file": path.name,
            "sha256": hash_file(path),
            "pieces": [hash_file(piece) for piece in pieces[path]],
        }
        for key, path in (("mesh", mesh), ("fractions", fractions))
    }


def survey_of(path: Path, threshold: float) -> Survey:
    """Return what a pass over written fractions finds.

    Parameters
    ----------
    path
        The file of `write_fractions`.
    threshold
        The threshold.

    Raises
    ------
    MeshError
        The fractions of a slab have another shape.
    """
    content = json.loads(path.read_text("utf-8"))
    found = Survey(BackgroundGrid.from_dict(content["grid"]), content["samples"], threshold)
    for number, row in enumerate(content["slabs"]):
        slab = Slab(number, row["begin"], row["end"])
        multiples = load_fractions(path.parent / row["file"]).multiples
        shape = tuple(2 * n + 1 for n in slab.grid(found.grid).shape)
        if multiples.shape != shape:
            raise MeshError(
                f"holds fractions of shape {multiples.shape}",
                where=str(path.parent / row["file"]),
                expected=f"the shape {shape} of its slab",
                remedy="make the mesh again",
            )
        found.add(slab, multiples)
    return found


class Bodies:
    """The grid cells whose bodies are in a mesh.

    Parameters
    ----------
    n_cells
        Number of cells of the grid.
    """

    def __init__(self, n_cells: int) -> None:
        self.found: BoolArray = np.zeros(n_cells, dtype=bool)

    def seen(self, pieces: Iterable[Piece]) -> Iterator[Piece]:
        """Yield pieces after noting their cells.

        Parameters
        ----------
        pieces
            The pieces of the mesh.
        """
        for piece in pieces:
            cells = piece.grid_cell[np.isin(piece.kind, (GRID_CELL, INNER_CELL))]
            self.found[cells[(cells >= 0) & (cells < len(self.found))]] = True
            yield piece

    def count_others(self, kept: BoolArray) -> int:
        """Return the number of cells that are either kept or in the mesh, not both.

        Parameters
        ----------
        kept
            The kept cells, shape n.
        """
        return int((self.found != kept.ravel()).sum())


def check_claims(
    stored: Mapping[str, Any], mesh: Path, measured: PiecesMeasurement, bodies: Bodies
) -> list[Check]:
    """Return the checks of a certificate's claims, recomputed from mesh and fractions.

    Parameters
    ----------
    stored
        The certificate.
    mesh
        The PVTU file.
    measured
        The measurement of the mesh.
    bodies
        The grid cells whose bodies are in the mesh.

    Raises
    ------
    MeshError
        The certificate is not that of a mesh in pieces.
    """
    if "pieces" not in stored["mesh"]:
        raise MeshError(
            "belongs to a mesh in one piece",
            where=str(mesh.parent / "certificate.json"),
            expected="the certificate of a mesh in pieces",
            remedy="check the .vtu file, or the .pvtu file in another folder",
        )
    recomputed = claims_of_mesh(stored, measured)
    fractions = mesh.parent / stored["fractions"]["file"]
    own = [hash_file(piece) for piece in pieces_in(mesh)]
    is_same = own == stored["mesh"]["pieces"]
    # One changed piece changes the mesh, as one changed byte does in one file.
    recomputed["mesh"] = hash_file(mesh) if is_same else "pieces differ"
    if fractions.is_file():
        cells = SlabCells.of(survey_of(fractions, stored["selection"]["threshold"]), mesh.stem)
        found = digests(mesh, fractions)["fractions"]
        is_same = found["pieces"] == stored["fractions"]["pieces"]
        recomputed |= {
            "fractions": found["sha256"] if is_same else "pieces differ",
            **claim_of_cells(cells, cells.raw),
            "cells": bodies.count_others(cells.kept),
        }
    return compare_claims(stored, recomputed)


def n_cells_of(stored: Mapping[str, Any], folder: Path) -> int:
    """Return the number of grid cells of a certified mesh; 0 if its fractions are not there.

    Parameters
    ----------
    stored
        The certificate.
    folder
        Its folder.
    """
    path = folder / stored["fractions"]["file"]
    if not path.is_file():
        return 0
    return BackgroundGrid.from_dict(json.loads(path.read_text("utf-8"))["grid"]).n_cells
