from pathlib import Path

from provenance.record import recorded
from tusqh.atomic import write_text
from tusqh.explorer.page import make_page
from tusqh.explorer.subject import read_subject

with recorded(snakemake) as log:
    page = Path(snakemake.output.page)
    settings = snakemake.params.settings
    text = make_page(read_subject(page.parent, settings=settings, **snakemake.params.source))
    log.info("%.2f MB", len(text) / 1e6)
    write_text(page, text)
