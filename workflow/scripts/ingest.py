from pathlib import Path

from provenance.record import recorded
from tusqh.geometry.canonical import write_geometry
from tusqh.pipeline.ingest import describe_geometry, ingest
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    geometry = ingest(snakemake.params.source, image=snakemake.params.image)
    defects = describe_geometry(geometry)
    log.info("%s: %d %s", geometry.name, defects["count"].iloc[0], defects["defect"].iloc[0])
    write_geometry(Path(snakemake.output.geometry), geometry)
    write_csv(Path(snakemake.output.defects), defects)
