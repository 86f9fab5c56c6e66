"""Compute element metrics with VTK, such as scaled Jacobian, aspect ratio, angles and area."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from tusqh.extras import require
from tusqh.geometry.units import in_unit
from tusqh.meshes.volume_mesh import VolumeMesh

#: Our column names, VTK's names, and units, by dimension.
METRICS = {
    2: {
        "scaled_jacobian": ("ScaledJacobian", "-"),
        "aspect_ratio": ("AspectRatio", "-"),
        "min_angle": ("MinAngle", "degree"),
        "max_angle": ("MaxAngle", "degree"),
        "area": ("Area", "model units^2"),
    },
    3: {
        "scaled_jacobian": ("ScaledJacobian", "-"),
        "edge_ratio": ("MaxEdgeRatio", "-"),
        "skew": ("Skew", "-"),
        "shape": ("Shape", "-"),
        "volume": ("Volume", "model units^3"),
    },
}
_UNITS = {name: unit for of_dim in METRICS.values() for name, (_, unit) in of_dim.items()}


def element_metrics(mesh: VolumeMesh) -> pd.DataFrame:
    """Return VTK's metrics of every element, one row each; NaN if VTK gives no finite value.

    The columns in 2D are scaled_jacobian (1 for a square), aspect_ratio (1 for a square), min_angle
    and max_angle in degrees, and area in model units squared.  In 3D they are scaled_jacobian,
    edge_ratio and shape (1 for a cube), skew (0 for a cube), and volume in model units cubed.

    Parameters
    ----------
    mesh
        The mesh.

    Raises
    ------
    MissingExtraError
        VTK is not installed; it comes with the extra `verdict`.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    >>> mesh = VolumeMesh.from_arrays(square, np.array([[0, 1, 2, 3]]))
    >>> element_metrics(mesh).round(6).iloc[0].tolist()
    [1.0, 1.0, 90.0, 90.0, 4.0]
    """
    # The modules of VTK alone; importing pyvista would take longer than measuring a small mesh.
    verdict = require("vtkmodules.vtkFiltersVerdict", extra="verdict")
    to_numpy = require("vtkmodules.util.numpy_support", extra="verdict").vtk_to_numpy
    measure = verdict.vtkCellQuality()
    measure.SetInputData(_to_vtk(mesh))
    columns = {}
    for ours, (vtk, _) in METRICS[mesh.dim].items():
        getattr(measure, f"SetQualityMeasureTo{vtk}")()
        measure.Update()
        values = measure.GetOutput().GetCellData().GetArray("CellQuality")
        columns[ours] = to_numpy(values).copy()
    table = pd.DataFrame(columns)
    return table.where(np.isfinite(table))


def _to_vtk(mesh: VolumeMesh) -> Any:
    """Return a mesh as a `vtkUnstructuredGrid`, moved to the origin."""
    model = require("vtkmodules.vtkCommonDataModel", extra="verdict")
    core = require("vtkmodules.vtkCommonCore", extra="verdict")
    to_vtk = require("vtkmodules.util.numpy_support", extra="verdict").numpy_to_vtk
    coordinates = np.zeros((len(mesh.points), 3))
    # Map coordinates are millions of metres, so move the mesh; this does not change the metrics.
    coordinates[:, : mesh.dim] = mesh.points - mesh.points[0]
    points = core.vtkPoints()
    points.SetData(to_vtk(coordinates, deep=True))
    corners = mesh.cells.astype(np.int64)
    starts = np.arange(0, corners.size + 1, corners.shape[1], dtype=np.int64)
    cells = model.vtkCellArray()
    cells.SetData(*(to_vtk(a, deep=True) for a in (starts, corners.ravel())))
    grid = model.vtkUnstructuredGrid()
    grid.SetPoints(points)
    grid.SetCells(model.VTK_QUAD if mesh.dim == 2 else model.VTK_HEXAHEDRON, cells)
    return grid


def summarise_metrics(metrics: pd.DataFrame, *, unit: str = "") -> pd.DataFrame:
    """Return one row per metric: minimum, 1 % quantile, median, mean, maximum and unit.

    Parameters
    ----------
    metrics
        The table of `element_metrics`.
    unit
        Unit of length of the mesh; empty if it is not known.
    """
    rows = [
        {
            "metric": name,
            "min": column.min(skipna=False),
            "p01": column.quantile(0.01),
            "median": column.median(),
            "mean": column.mean(),
            "max": column.max(skipna=False),
            "unit": in_unit(_UNITS[str(name)], unit),
        }
        for name, column in metrics.items()
    ]
    return pd.DataFrame(rows, columns=["metric", "min", "p01", "median", "mean", "max", "unit"])


def describe_elements(summary: pd.DataFrame) -> dict[str, str]:
    """Return a line on the quality and size of the elements; none if VTK did not measure them.

    Parameters
    ----------
    summary
        The table of `summarise_metrics`.
    """
    table = summary.set_index("metric")
    if table.empty:
        return {}
    scaled = table.loc["scaled_jacobian"]
    name = "area" if "area" in table.index else "volume"
    size = table.loc[name]
    return {
        "elements": f"scaled Jacobian at least {scaled['min']:.3f} (1 %: {scaled['p01']:.3f}, "
        f"median {scaled['median']:.3f}), {name} {size['min']:.3g} to {size['max']:.3g}"
    }
