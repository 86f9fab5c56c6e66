"""The report of a mesh in a few lines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import pandas as pd

from tusqh.geometry.remark import Remark
from tusqh.pipeline.describe_reading import lines_of_reading
from tusqh.pipeline.judge import Judgement
from tusqh.quality.elements import describe_elements
from tusqh.quality.fit_checks import describe_fit
from tusqh.quality.verdict import compare_volumes, describe_changes, describe_contacts
from tusqh.sampling.placement import Placement
from tusqh.threshold.selection import Selection
from tusqh.topology.betti_numbers import BettiNumbers

__all__ = ["Report"]


@dataclass(frozen=True)
class Report:
    """A report of the request, prediction, choice, measurement and verdict.

    Parameters
    ----------
    name
        The model.
    selection
        The threshold, the reason for its choice, and how far it can move.
    facts
        Numbers that describe the mesh, such as cells, elements, contacts and volume.
    elements
        Summary of the element metrics.
    verdict
        One row per check, see `tusqh.quality.verdict.to_table`.
    reading
        Description of the reading, see `tusqh.pipeline.describe_reading.describe_reading`.
    remarks
        Remarks on what reading and orienting the geometry left out, changed or noted.
    coarse
        A line on the coarse mesh; None if none was asked for.
    """

    name: str
    selection: Selection
    facts: dict[str, Any]
    elements: pd.DataFrame
    verdict: pd.DataFrame
    reading: dict[str, Any]
    remarks: tuple[Remark, ...] = ()
    coarse: str | None = None

    @property
    def predicted(self) -> BettiNumbers:
        """Betti numbers that were predicted before meshing."""
        return self.selection.predicted

    @property
    def measured(self) -> BettiNumbers:
        """Betti numbers of the mesh, by its Euler characteristic."""
        return BettiNumbers(*self.facts["betti_measured"])

    @property
    def is_met(self) -> bool:
        """Whether the measured Betti numbers are as predicted and hence as requested."""
        return self.measured == self.predicted

    @property
    def is_suitable(self) -> bool:
        """Whether no check of the verdict fails; there may be warnings."""
        return Judgement(self.elements, self.verdict).is_suitable

    @property
    def has_warnings(self) -> bool:
        """Whether the mesh is suitable with warnings only."""
        return Judgement(self.elements, self.verdict).has_warnings

    def lines(self) -> dict[str, str]:
        """Return the report in a few lines, each with its title."""
        chosen, facts = self.selection, self.facts
        of_mesh = {
            "wanted": chosen.wanted,
            "predicted": f"Betti numbers {self.predicted}",
            "threshold": f"{chosen.threshold:.6g}: {chosen.extent}; {chosen.reason}",
            "measured": f"Betti numbers {self.measured}, "
            + ("as predicted" if self.is_met else "NOT as predicted"),
            "mesh": f"{facts['elements']:,} {'hexes' if facts['dimension'] == 3 else 'quads'} of "
            f"{facts['grid']} cells, {describe_contacts(facts)}, "
            f"volume {compare_volumes(facts)}",
            **describe_changes(facts),
            **describe_elements(self.elements),
            **describe_fit(facts),
            **({} if self.coarse is None else {"coarse": self.coarse}),
            **self._placement(),
            "verdict": str(Judgement(self.elements, self.verdict)),
            **self._not_run(),
        }
        return lines_of_reading(self.reading) | of_mesh | self._warnings() | self._remarks()

    def _placement(self) -> dict[str, str]:
        """Return lines on boxes, turned axes and the placement of the grid, where there are any."""
        facts, lines = self.facts, {}
        if "sides" in facts:
            lines["cells"] = "boxes of " + " x ".join(f"{side:.6g}" for side in facts["sides"])
        if "axes" in facts:
            lines["axes"] = "turned to " + ", ".join(
                "(" + ", ".join(f"{x:.4g}" for x in axis) + ")" for axis in facts["axes"]
            )
        if "placement" in facts:
            lines["grid"] = str(Placement.from_dict(facts["placement"]))
        return lines

    def _not_run(self) -> dict[str, str]:
        """Return a line on the programs that did not check the mesh because it is large."""
        rows = self.verdict[self.verdict["id"].str.startswith("checks_by_")]
        if rows.empty:
            return {}
        reason = rows["found"].iloc[0].removeprefix("not run: ")
        return {"not run": f"{', '.join(rows['name'])}: {reason}"}

    def _remarks(self) -> dict[str, str]:
        """Return a line for each remark on the geometry."""
        return {f"remark {k}": str(remark) for k, remark in enumerate(self.remarks, start=1)}

    def _warnings(self) -> dict[str, str]:
        """Return a line for each warning, with the finding and the remedy."""
        rows = self.verdict[self.verdict["holds"] == "warning"]
        return {
            f"warning {k}": f"{row.name}: {row.found} (without a warning: {row.required}); "
            f"{row.remedy}"
            for k, row in enumerate(rows.itertuples(index=False), start=1)
        }

    def __str__(self) -> str:
        """Return the report as text."""
        return "\n".join(f"{title:<10} {text}" for title, text in self.lines().items())
