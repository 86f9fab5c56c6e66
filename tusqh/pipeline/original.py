"""The original of a mesh: its geometry, and the settings with which the two are compared."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from tusqh.antialias.resolve import Resolved
from tusqh.geometry.kinds import Geometry
from tusqh.meshes.checks import Check
from tusqh.pipeline.sample import sample_with_reference
from tusqh.progress import Progress, log_progress
from tusqh.quality.comparison import Compared, compare_with_geometry
from tusqh.sampling.fractions import VolumeFractions
from tusqh.sampling.reference import Reference, find_reference
from tusqh.settings.grid import Grid, Window
from tusqh.settings.quality import Quality
from tusqh.settings.sampling import Sampling
from tusqh.settings.section import to_plain


@dataclass(frozen=True)
class Original:
    """The geometry of a mesh, and the settings for its sampling and the comparison.

    Parameters
    ----------
    geometry
        The geometry.
    grid, sampling, window, threshold
        See `tusqh.pipeline.sample.sample`.
    quality
        How much the mesh may differ from the geometry.
    """

    geometry: Geometry = field(repr=False)
    grid: Grid
    sampling: Sampling
    window: Window | None = None
    quality: Quality = field(default_factory=Quality)
    threshold: float | None = None

    @classmethod
    def from_dict(cls, geometry: Geometry, settings: Mapping[str, Any]) -> Original:
        """Return the original with settings that `to_dict` described.

        Parameters
        ----------
        geometry
            The geometry.
        settings
            The sections by name, as plain values.
        """
        window = settings.get("window")
        return cls(
            geometry,
            Grid.from_dict(settings["grid"]),
            Sampling.from_dict(settings["sampling"]),
            window and Window.from_dict(window),
            Quality.from_dict(settings["quality"]),
            settings.get("threshold"),
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the settings as plain values, for JSON, without those that are None."""
        sections = {
            "grid": self.grid,
            "sampling": self.sampling,
            "window": self.window,
            "quality": self.quality,
            "threshold": self.threshold,
        }
        return dict(to_plain(sections))

    def sample(self, progress: Progress = log_progress) -> VolumeFractions:
        """Return the volume fractions of the geometry.

        Parameters
        ----------
        progress
            Shows how many samples have been taken.
        """
        return self.sample_with_reference(progress)[0]

    def sample_with_reference(
        self, progress: Progress = log_progress
    ) -> tuple[VolumeFractions, Reference]:
        """Return the volume fractions of the geometry and the volume that the mesh should have.

        Parameters
        ----------
        progress
            Shows how many samples have been taken.

        Returns
        -------
        fractions
            The volume fractions.
        reference
            The volume that the mesh should have.
        """
        fractions, reference = sample_with_reference(
            self.geometry,
            grid=self.grid,
            sampling=self.sampling,
            window=self.window,
            threshold=self.threshold,
            progress=progress,
        )
        return fractions, reference or self.reference(fractions)

    def reference(self, fractions: VolumeFractions) -> Reference:
        """Return the volume that the mesh should have.

        Parameters
        ----------
        fractions
            The volume fractions of the geometry.
        """
        box = None if self.window is None else self.window.box
        return find_reference(self.geometry, fractions, sampling=self.sampling, window=box)

    def compare(self, resolved: Resolved, fractions: Compared, reference: Reference) -> list[Check]:
        """Return the differences between a mesh and the geometry.

        Parameters
        ----------
        resolved
            The mesh and its cells.
        fractions
            The volume fractions from which it was made.
        reference
            The volume that it should have.
        """
        tolerance = self.quality.volume_tolerance
        return compare_with_geometry(
            resolved, fractions, self.geometry, reference, tolerance=tolerance
        )


def to_warnings(comparison: Sequence[Check]) -> list[dict[str, str]]:
    """Return the checks that fail, in the form of a certificate.

    Parameters
    ----------
    comparison
        See `Original.compare`.
    """
    return [
        {"id": c.id, "name": c.name, "found": str(c.found), "remedy": c.remedy}
        for c in comparison
        if not c.holds
    ]
