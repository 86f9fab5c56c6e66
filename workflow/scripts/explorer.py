from pathlib import Path

from tusqh.atomic import write_text
from tusqh.explorer.command import mesh_command
from tusqh.explorer.page import make_page, stands_on_y
from tusqh.explorer.subject import read_subject
from tusqh.provenance.record import recorded

with recorded(snakemake) as log:
    page, name = Path(snakemake.output.page), snakemake.wildcards.model
    geometry, unit = (snakemake.params.source[key] for key in ("geometry", "unit"))
    command = mesh_command(geometry, snakemake.params.settings, name=name)
    subject = read_subject(page.parent, name=name, unit=unit, command=command)
    text = make_page(subject, y_up=stands_on_y(geometry))
    log.info("%.2f MB", len(text) / 1e6)
    write_text(page, text)
