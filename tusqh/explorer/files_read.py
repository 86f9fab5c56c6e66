"""Files of a model that the explorer reads, by their names in `tusqh.files`."""

#: Tables that the page shows without change, by their names in `tusqh.files`.
TABLES_SHOWN = ("defects", "elements", "verdict", "features", "bridges")

#: Files of a model's results that the explorer reads, by their names in `tusqh.files`.
FILES_READ = (
    *("geometry", "fractions", "curves", "topologies", "diagram", "selection", "mesh"),
    *TABLES_SHOWN,
)

#: The same for a model of several materials.
TABLES_OF_MATERIALS = ("materials", "pairs", "elements", "verdict")
FILES_OF_MATERIALS = ("mesh", "fractions", "certificate", *TABLES_OF_MATERIALS)
