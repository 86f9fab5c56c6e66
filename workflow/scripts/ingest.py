from pathlib import Path

from provenance.record import recorded
from tusqh.atomic import write_text
from tusqh.geometry.canonical import write_geometry
from tusqh.hashing import canonical_json
from tusqh.pipeline.describe_reading import describe_reading, lines_of_reading
from tusqh.pipeline.ingest import describe_geometry, read_source
from tusqh.pipeline.unused_settings import with_unused
from tusqh.settings.lengths import Lengths
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    params = snakemake.params
    lengths = Lengths.from_dict(params.lengths)
    reading = read_source(params.source, image=params.image, lengths=lengths)
    reading = with_unused(reading, params.unused)
    read = describe_reading(reading)
    for title, line in lines_of_reading(read).items():
        log.info("%s: %s", title, line)
    for remark in reading.remarks:
        log.info("%s", remark)
    write_geometry(Path(snakemake.output.geometry), reading.geometry)
    write_text(Path(snakemake.output.reading), canonical_json(read))
    write_csv(Path(snakemake.output.defects), describe_geometry(reading.geometry))
