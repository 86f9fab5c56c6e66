"""Check a mesh in pieces, and its certificate, from its files."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from tusqh.certificate import FILE_NAME, read_certificate
from tusqh.meshes.checks import Check
from tusqh.meshes.measure_pieces import PiecesMeasurement, measure_pieces
from tusqh.meshes.piece_files import read_pieces
from tusqh.pipeline.slabs.certificate import Bodies, check_claims, n_cells_of
from tusqh.pipeline.slabs.found import PiecedMesh
from tusqh.quality.verdict import judge_alone, to_table
from tusqh.topology.betti_numbers import BettiNumbers

#: Why something is not checked.
_IN_PIECES = "a mesh in pieces; other programs need it in one"


def check_in_pieces(path: Path) -> tuple[pd.DataFrame, PiecesMeasurement]:
    """Return the checks of a mesh in pieces and of its certificate, and its measurement.

    The fractions are not sampled again; the warnings are those that the certificate records.

    Parameters
    ----------
    path
        The PVTU file; a certificate in its folder is recomputed.

    Returns
    -------
    checks
        The checks, see `tusqh.quality.verdict.to_table`.
    measurement
        The measurement of the mesh.

    Raises
    ------
    MeshError
        The pieces or the certificate cannot be read.
    """
    certificate = path.parent / FILE_NAME
    claims: list[Check] = []
    if certificate.is_file():
        stored = read_certificate(certificate)
        bodies = Bodies(n_cells_of(stored, path.parent))
        measured = measure_pieces(bodies.seen(read_pieces(path)), name=path.stem)
        expected = BettiNumbers(*stored["predicted"]["effective"])
        claims = check_claims(stored, path, measured, bodies)
        claims += [_not_sampled(), *_recorded(stored.get("warnings", []))]
    else:
        measured = measure_pieces(read_pieces(path), name=path.stem)
        expected = measured.by_euler
    mesh = PiecedMesh(path.stem, measured).as_mesh()
    table = to_table([*judge_alone(mesh, expected, _IN_PIECES), *claims])
    return table.drop(columns="material"), measured


def _not_sampled() -> Check:
    return Check(
        id="certificate_geometry",
        name="certificate: fractions from the geometry",
        found="not run: the geometry of a mesh in pieces is not sampled again",
        required="the same fractions",
        holds=None,
    )


def _recorded(warnings: list[dict[str, str]]) -> list[Check]:
    """Return the warnings that a certificate records."""
    return [
        Check(
            id=warning["id"],
            name=warning["name"],
            found=warning["found"],
            required="as recorded by the certificate",
            holds=False,
            is_warning=True,
            remedy=warning["remedy"],
        )
        for warning in warnings
    ]
