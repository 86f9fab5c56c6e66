from pathlib import Path

from provenance.record import recorded
from studies.pictures import copy_pictures
from studies.render_page import render_page
from tusqh.atomic import write_text

with recorded(snakemake) as log:
    figures = list(snakemake.input.figures)
    text = render_page(
        Path(snakemake.input.template), tables=snakemake.input.tables, figures=figures
    )
    written = copy_pictures(figures, Path(snakemake.output.pictures[0]).parent)
    write_text(Path(snakemake.output.page), text)
    log.info("%d lines, %d pictures", text.count("\n"), len(written))
