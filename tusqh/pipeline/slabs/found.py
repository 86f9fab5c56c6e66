"""What is known about a finished mesh in slabs: report, certificate and tables."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from tusqh.antialias.resolve import Resolved, describe_mesh
from tusqh.atomic import write_text
from tusqh.certificate import FILE_NAME, certify
from tusqh.geometry.remark import Remark
from tusqh.hashing import canonical_json
from tusqh.meshes.checks import Check
from tusqh.meshes.measure_pieces import PiecesMeasurement
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.pipeline.original import Original, to_warnings
from tusqh.pipeline.report import Report
from tusqh.pipeline.slabs.cells import SlabCells
from tusqh.pipeline.slabs.certificate import digests, write_fractions
from tusqh.pipeline.slabs.sample import Sampled
from tusqh.quality.elements import summarise_metrics
from tusqh.quality.verdict import judge_alone, to_table
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.tables import write_csv
from tusqh.threshold.selection import Interval, Selection


@dataclass(frozen=True)
class PiecedMesh:
    """A mesh in pieces, in the form in which checks and tables take a mesh.

    Parameters
    ----------
    name
        The model.
    measurement
        The measurement of the pieces.
    """

    name: str
    measurement: PiecesMeasurement

    @property
    def dim(self) -> int:
        """Dimension of the mesh."""
        return 3

    @property
    def n_cells(self) -> int:
        """Number of elements."""
        return self.measurement.n_cells

    @property
    def n_points(self) -> int:
        """Number of points."""
        return self.measurement.n_points

    @property
    def sides(self) -> tuple[float, ...]:
        """Sides of cells that are not cubes: there are none in slabs."""
        return ()

    @property
    def kind(self) -> NDArray[np.int64]:
        """The kinds of element that occur."""
        return np.array(self.measurement.kinds, dtype=np.int64)

    def as_mesh(self) -> VolumeMesh:
        """Return this object under the type of a mesh; it has no points and no elements."""
        return cast("VolumeMesh", self)


@dataclass(frozen=True)
class Found:
    """Everything that is known about a finished mesh in slabs.

    Parameters
    ----------
    original
        The surface, and the settings with which it was sampled.
    sampled
        Its fractions.
    cells
        The kept cells.
    measured
        The measurement of the pieces.
    name
        The model.
    """

    original: Original
    sampled: Sampled
    cells: SlabCells
    measured: PiecesMeasurement
    name: str

    @property
    def resolved(self) -> Resolved:
        """The mesh with its cells."""
        return Resolved(PiecedMesh(self.name, self.measured).as_mesh(), self.cells)

    def selection(self) -> Selection:
        """Return the threshold; it is examined only where the cells stay the same."""
        cells, survey = self.cells, self.sampled.survey
        lower, upper = survey.lower * RESOLUTION, survey.upper * RESOLUTION
        margin = min(cells.threshold - lower, upper - cells.threshold)
        return Selection(
            threshold=cells.threshold,
            cells_lower=lower,
            cells_upper=upper,
            wanted=f"the threshold {cells.threshold:g}",
            raw=cells.raw,
            predicted=cells.predicted,
            reason="given; in slabs only thresholds with the same cells are examined",
            policy=self.sampled.policy,
            find_interval=lambda: Interval(lower, upper, max(margin, 0.0), 0.0),
            cells=cells,
        )

    def comparison(self) -> list[Check]:
        """Return the checks of the mesh against the geometry."""
        return self.original.compare(self.resolved, self.sampled.survey, self.sampled.reference)

    def report(self, reading: dict[str, Any], remarks: tuple[Remark, ...]) -> Report:
        """Return the report.

        Parameters
        ----------
        reading
            What was read, see `tusqh.pipeline.describe_reading.describe_reading`.
        remarks
            Remarks on reading and orienting the geometry.
        """
        comparison, selection = self.comparison(), self.selection()
        mesh = PiecedMesh(self.name, self.measured).as_mesh()
        skipped = "a mesh in slabs; other programs need it in one piece"
        verdict = to_table([*judge_alone(mesh, selection.predicted, skipped), *comparison])
        facts = {
            "threshold": selection.threshold,
            "margin": selection.margin,
            **describe_mesh(self.resolved, self.sampled.survey),
            "slabs": len(self.sampled.fractions.slabs),
            "reference_volume": self.sampled.reference.volume,
            "reference_source": self.sampled.reference.source,
            "comparison": [asdict(check) for check in comparison],
        }
        if self.sampled.placement is not None:
            facts["placement"] = self.sampled.placement.to_dict()
        nothing = summarise_metrics(pd.DataFrame())
        return Report(self.name, selection, facts, nothing, verdict, reading, remarks)

    def certify(self, folder: Path, report: Report) -> None:
        """Write fractions, certificate, facts and verdict beside the mesh in a folder.

        Parameters
        ----------
        folder
            The folder of ``mesh.pvtu``.
        report
            The report.
        """
        named = write_fractions(folder, self.sampled.fractions)
        files = digests(folder / "mesh.pvtu", named)
        claim = certify(report.selection, self.cells, self.measured, files, name=self.name)
        if self.sampled.placement is not None:
            claim["placement"] = self.sampled.placement.to_dict()
        claim["settings"] = self.original.to_dict()
        claim["warnings"] = to_warnings(self.comparison())
        write_text(folder / FILE_NAME, canonical_json(claim))
        write_text(folder / "facts.json", canonical_json(report.facts))
        write_csv(folder / "verdict.csv", report.verdict)
