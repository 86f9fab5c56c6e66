from pathlib import Path

from provenance.record import recorded
from studies.pinch_catalogue import connect_edges, resolve_series, tabulate_catalogue
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    tables = [*tabulate_catalogue(), *resolve_series(), *connect_edges()]
    names = ("catalogue", "elements", "series", "series_shapes", "edges", "edges_shapes")
    for name, table in zip(names, tables, strict=True):
        write_csv(Path(snakemake.output[name]), table)
    resolved = tables[0][tables[0]["stage"] != "raw"]
    log.info("%d of %d resolved pinches are sound", resolved["sound"].sum(), len(resolved))
