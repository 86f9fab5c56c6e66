"""The names, columns and meanings of the files of a model's results, in one place.

The rules of the workflow, `Result.save`, the explorer and the overview all take the names of files
from here.  ``docs/files.md`` lists them with the rules that write and read each one.
"""

from __future__ import annotations

from pathlib import Path

from tusqh.result_file import ResultFile, columns


def path_of(name: str, folder: Path) -> Path:
    """Return the path of a file of a model's results.

    Parameters
    ----------
    name
        The name of the file, a key of `RESULT_FILES`.
    folder
        The folder of the model's results.

    Returns
    -------
    Path
        The path, whether the file exists or not.

    Raises
    ------
    KeyError
        There is no such name.

    Examples
    --------
    >>> path_of("curves", Path("results/torus")).as_posix()
    'results/torus/curves.csv'
    """
    return folder / RESULT_FILES[name].path


_BETTI = "betti_0 betti_1 betti_2"
_CELL_SET = "cells contacts bridges removed filled"
_AT = "{0}_at {0}_i {0}_j {0}_k {0}_x {0}_y {0}_z"

_GEOMETRY_TO_SELECTION = (
    ResultFile("geometry", "geometry.vtp", "the geometry as it was read, without any repair"),
    ResultFile(
        "reading",
        "reading.json",
        "what was read from the file: counts, bounding box, unit, and what was left out or changed",
    ),
    ResultFile(
        "defects",
        "defects.csv",
        "the defects of the geometry, counted and measured",
        columns("defect count measure unit explanation"),
    ),
    ResultFile("fractions", "fractions.npz", "the volume fractions of cells and sub-cells"),
    ResultFile(
        "curves",
        "curves.csv",
        "the Betti numbers of the filtration at every plateau of the threshold",
        columns("upper lower width", _BETTI, "euler"),
    ),
    ResultFile(
        "diagram",
        "diagram.csv",
        "the persistence pairs, with the cells that create and destroy each feature",
        columns(
            "dimension birth death persistence essential", _AT.format("birth"), _AT.format("death")
        ),
    ),
    ResultFile(
        "diagonal",
        "diagonal.csv",
        "the number of persistence pairs that are born and die at the same volume fraction",
        columns("dimension birth pairs"),
    ),
    ResultFile(
        "topologies",
        "topologies.csv",
        "the topology of the mesh at every plateau of the threshold",
        columns(
            "upper lower width threshold",
            _CELL_SET,
            _BETTI,
            "volume_ratio raw_betti_0 raw_betti_1 raw_betti_2 raw_agrees",
        ),
    ),
    ResultFile(
        "candidates",
        "candidates.csv",
        "the intervals of the threshold that give the wanted topology, ranked, with margins",
        columns(
            "rank threshold upper lower width margin unexamined plateaus",
            _CELL_SET,
            _BETTI,
            "volume_ratio raw_betti_0 raw_betti_1 raw_betti_2 raw_agrees status",
        ),
    ),
    ResultFile(
        "prices",
        "prices.csv",
        "what it costs to open, cut or fill each class of the diagram at the base, by itself",
        columns("row class birth death do change cells volume", _BETTI, "possible why x y z"),
        columns(
            "material row class birth death do cells volume volumes",
            _BETTI,
            "others possible why x y z",
        ),
    ),
    ResultFile(
        "selection",
        "selection.json",
        "the selected threshold, its interval, the policy, and the reason for the choice",
    ),
)

_MESH_TO_VERDICT = (
    ResultFile("mesh", "mesh.vtu", "the mesh, for ParaView, meshio and MFEM"),
    ResultFile("facts", "facts.json", "the size, topology and volume of the mesh"),
    ResultFile(
        "features",
        "features.csv",
        "every small component that was removed and every small hole or void that was filled",
        columns(
            "feature cells volume persistence smallest_fraction largest_fraction",
            "interior_sub_cells x y z",
        ),
    ),
    ResultFile(
        "bridges",
        "bridges.csv",
        "the bridges that join archipelagos, and the components that could not be joined",
        columns("kind edges length cells_a cells_b x_a y_a z_a x_b y_b z_b status"),
    ),
    ResultFile(
        "changes",
        "changes.csv",
        "with local scope: the cells that differ from those of the base, in groups",
        columns("change cells volume smallest_fraction largest_fraction do class row x y z"),
        columns("from to cells volume do material class row x y z"),
    ),
    ResultFile(
        "certificate",
        "certificate.json",
        "the wanted, predicted and measured topology, with digests; `tusqh check` recomputes it",
    ),
    ResultFile(
        "coarse", "coarse.vtu", "with `coarsen`: the mesh with larger elements inside, as VTU"
    ),
    ResultFile(
        "coarse_mfem",
        "coarse.mesh",
        "with `coarsen`: that mesh for MFEM, with its hanging vertices if it has any",
    ),
    ResultFile(
        "coarsening",
        "coarsening.json",
        "with `coarsen`: elements and digests of that mesh; `tusqh check` recomputes it",
    ),
    ResultFile(
        "fitted", "fitted.vtu", "with `fit`: the mesh with its boundary moved onto the geometry"
    ),
    ResultFile(
        "fit",
        "fit.json",
        "with `fit`: topology, distances and digests of that mesh; `tusqh check` recomputes it",
    ),
    ResultFile(
        "distances",
        "distances.csv",
        "with `fit`: the distances from the boundary to the surface and back",
        columns("from at count unit mean p99 max"),
    ),
    ResultFile(
        "unfitted",
        "unfitted.csv",
        "with `fit`: every part of the boundary that does not follow the surface, and why",
        columns("x y z points what why"),
    ),
    ResultFile(
        "chains",
        "chains.csv",
        "with `fit`, in space: every chain of creases, how much of it was captured, and why not",
        columns(
            "patch_a patch_b length cells captured mean_distance max_distance from_boundary",
            "min_scaled_jacobian x y z why",
        ),
    ),
    ResultFile(
        "patches",
        "patches.csv",
        "with `fit`: the smooth patch of the geometry to which every boundary facet belongs",
        columns("element facet patch"),
    ),
    ResultFile(
        "elements",
        "elements.csv",
        "the statistics of the element metrics",
        columns("metric min p01 median mean max unit"),
    ),
    ResultFile(
        "verdict",
        "verdict.csv",
        "every check of the mesh: found, required, holds",
        columns("id material name found required holds remedy"),
    ),
    ResultFile(
        "verification",
        "verification.csv",
        "the predicted and measured topology at every threshold of the sweep",
        columns(
            "model material dimension grid threshold scope cells_kept elements contacts overruled",
            "betti_0_predicted betti_1_predicted betti_2_predicted",
            "betti_0_measured betti_1_measured betti_2_measured",
            "manifold conforming min_scaled_jacobian holds",
        ),
    ),
)

_MATERIALS = (
    ResultFile(
        "materials",
        "materials.csv",
        "of several materials: the threshold, the volume and the topology of each",
        columns(
            "material threshold elements volume volume_of_geometry",
            "betti_0_predicted betti_1_predicted betti_2_predicted",
            "betti_0_measured betti_1_measured betti_2_measured",
            "manifold min_scaled_jacobian holds",
        ),
    ),
    ResultFile(
        "pairs",
        "pairs.csv",
        "of several materials: the overlap, the gap and the interface of every two",
        columns("first second overlap gap facets area"),
    ),
    ResultFile("figure_materials", "figures/materials.png", "the mesh, coloured by material"),
)

_SLABS = (
    ResultFile("slab_grid", "slabs/grid.json", "with `slabs`: the grid, and how it was placed"),
    ResultFile(
        "slab_contacts",
        "slabs/contacts.npz",
        "with `slabs`: the decisions at contacts, by slab",
    ),
    ResultFile(
        "slab_fractions",
        "fractions.json",
        "with `slabs`: the files of the fractions, by slab",
    ),
    ResultFile("slab_mesh", "mesh.pvtu", "with `slabs`: the mesh in pieces, for ParaView"),
)

_USES = (
    ResultFile("export_mfem", "export/mesh.mesh", "the mesh for MFEM"),
    ResultFile("export_gmsh", "export/mesh.msh", "the mesh for Gmsh, with physical groups"),
    ResultFile("export_exodus", "export/mesh.exo", "the mesh in Exodus II, with side sets"),
    ResultFile("export_abaqus", "export/mesh.inp", "the mesh for Abaqus, with surfaces"),
    ResultFile(
        "sets",
        "sets.csv",
        "the named sets of facets, points and elements in the exports",
        columns("name kind number facets elements points area volume x y z meaning"),
    ),
    ResultFile(
        "simulation",
        "simulation/concentration.pvd",
        "a contaminant that spreads in the mesh (in 3D, heat), for ParaView",
    ),
    ResultFile(
        "amount",
        "simulation/amount.csv",
        "the conserved amount and the extremes of the concentration in every snapshot",
        columns(
            "step time_s amount amount_unit amount_relative_error",
            "concentration_min concentration_max concentration_unit undershoot",
        ),
    ),
    ResultFile(
        "explorer",
        "explorer.html",
        "the model in a browser, with a slider over the threshold or with materials to hide",
    ),
)

_FIGURES = (
    ResultFile(
        "figure_fit", "figures/fit.png", "the model, its staircase and its fitted mesh, with `fit`"
    ),
    ResultFile("figure_sets", "figures/sets.png", "the named sets of a mesh, with `fit`"),
    ResultFile("figure_jacobians", "figures/jacobians.png", "scaled Jacobians, with `fit`"),
    ResultFile("figure_field", "figures/field.png", "the volume fractions of an outline"),
    ResultFile("figure_thresholds", "figures/thresholds.png", "an outline at three thresholds"),
    ResultFile("figure_panels", "figures/panels.png", "a solid at every threshold of the sweep"),
    ResultFile("figure_section", "figures/section.png", "sections of the mesh and its geometry"),
    ResultFile("figure_diagram", "figures/diagram.png", "the persistence diagram"),
    ResultFile("figure_curves", "figures/curves.png", "the Betti numbers at every threshold"),
    ResultFile(
        "figure_antialias",
        "figures/antialias.png",
        "interior sub-cells and templates where the most pinches are",
    ),
    ResultFile("figure_contaminant", "figures/contaminant.png", "a contaminant in the mesh"),
    ResultFile("figure_temperature", "figures/temperature.png", "heat that spreads in the mesh"),
)

#: Every file of a model's results by name, in the order in which the workflow makes them.
RESULT_FILES = {
    file.name: file
    for file in (
        *_GEOMETRY_TO_SELECTION,
        *_MESH_TO_VERDICT,
        *_MATERIALS,
        *_SLABS,
        *_USES,
        *_FIGURES,
    )
}

#: Tables over all models, with their path below ``results``.
TABLES_OF_ALL_MODELS = (
    ResultFile(
        "verdicts",
        "tables/verdicts.csv",
        "the volume of every mesh against its reference, the warnings and the verdict",
        columns("model file reference reference_volume volume volume_ratio warnings verdict"),
    ),
    ResultFile(
        "fit_table",
        "tables/fit.csv",
        "with `fit`: quality, distances in cells and topology of every fitted mesh",
        columns(
            "model dimension grid elements min_scaled_jacobian share_below_0_3",
            "mean_distance p99_distance max_distance surface_mean_distance volume_error",
            "resolved_mean_distance resolved_p99_distance",
            "self_intersections betti_same fell_back trusted unresolved",
        ),
    ),
    ResultFile(
        "fit_timing",
        "tables/fit_timing.csv",
        "with `fit`: what every fit took, which differs from run to run",
        columns("model seconds peak_gb"),
    ),
)
