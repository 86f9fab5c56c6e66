import shutil
from pathlib import Path

from provenance.record import recorded
from tusqh.atomic import replacing

with recorded(snakemake) as log:
    sources = [snakemake.input.page, *snakemake.input.pictures]
    targets = [snakemake.output.page, *snakemake.output.pictures]
    for source, target in zip(sources, targets, strict=True):
        with replacing(Path(target)) as temporary:
            shutil.copyfile(source, temporary)
    log.info("%d files", len(targets))
