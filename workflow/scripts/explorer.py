from pathlib import Path

from provenance.record import recorded
from tusqh.atomic import write_text
from tusqh.explorer.page import make_page
from tusqh.explorer.subject import read_subject
from tusqh.settings.model import Settings

with recorded(snakemake) as log:
    page = Path(snakemake.output.explorer)
    subject = read_subject(
        page.parent,
        geometry=snakemake.params.geometry,
        up=snakemake.params.up,
        fitted=bool(snakemake.input.fitted),
        settings=Settings.from_dict(snakemake.params.settings),
    )
    text = make_page(subject)
    log.info("%.2f MB", len(text) / 1e6)
    write_text(page, text)
