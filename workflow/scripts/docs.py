import shutil
from pathlib import Path

from tusqh.atomic import replacing
from tusqh.provenance.record import recorded

with recorded(snakemake) as log:
    sources = [snakemake.input.page, *snakemake.input.pictures]
    targets = [snakemake.output.page, *snakemake.output.pictures]
    for source, target in zip(sources, targets, strict=True):
        with replacing(Path(target)) as temporary:
            shutil.copyfile(source, temporary)
    log.info("%d files", len(targets))
