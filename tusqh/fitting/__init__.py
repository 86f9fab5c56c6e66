"""Move the boundary of a mesh onto the surface, without a change of its topology."""

from tusqh.fitting.fit import fit_mesh
from tusqh.fitting.fitted import Fitted
from tusqh.fitting.target import Target

__all__ = ["Fitted", "Target", "fit_mesh"]
