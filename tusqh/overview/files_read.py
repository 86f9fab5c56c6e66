"""Files of a model that the overview reads or links to."""

#: Files of a model that the overview reads, by their names in `tusqh.files`.
FILES_READ = ("certificate", "facts", "reading", "defects", "candidates", "verdict", "verification")

#: Titles of the files of a model that the overview links to, by their names in `tusqh.files`.
LINK_TITLES = {
    "explorer": "explorer",
    "mesh": "mesh (VTU)",
    "export_mfem": "for MFEM",
    "export_gmsh": "for Gmsh",
    "export_exodus": "for Exodus",
    "export_abaqus": "for Abaqus",
    "sets": "named sets in these",
    "certificate": "certificate",
    "diagram": "persistence diagram",
    "topologies": "all topologies",
    "bridges": "bridges",
    "features": "removed and filled",
    "changes": "cells that differ from the base",
    "simulation": "simulation (ParaView)",
}

#: Further files of a model whose boundary is fitted.
LINK_TITLES_OF_FIT = {"fitted": "fitted mesh (VTU)", "fit": "record of the fit"}

#: The same files and titles for a model of several materials.
FILES_READ_OF_MATERIALS = ("certificate", "materials", "pairs", "verdict", "verification")
LINK_TITLES_OF_MATERIALS = {
    name: LINK_TITLES[name]
    for name in LINK_TITLES
    if name in ("explorer", "mesh", "sets") or name.startswith("export_")
} | {
    "certificate": "certificate",
    "materials": "materials",
    "pairs": "pairs",
    "verdict": "all checks",
}
