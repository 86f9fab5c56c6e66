from pathlib import Path

from tusqh.atomic import write_text
from tusqh.explorer.page import make_page
from tusqh.explorer.subject import read_subject
from tusqh.provenance.record import recorded

with recorded(snakemake) as log:
    page = Path(snakemake.output.page)
    settings = snakemake.params.settings
    text = make_page(read_subject(page.parent, settings=settings, **snakemake.params.source))
    log.info("%.2f MB", len(text) / 1e6)
    write_text(page, text)
