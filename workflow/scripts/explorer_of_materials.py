from pathlib import Path

from provenance.record import recorded
from tusqh.atomic import write_text
from tusqh.explorer.materials import make_materials_page, read_materials_subject
from tusqh.geometry.upright import upright_axis

with recorded(snakemake) as log:
    page, params = Path(snakemake.output.explorer), snakemake.params
    up = upright_axis(params.geometry, params.up)
    text = make_materials_page(read_materials_subject(page.parent, geometry=params.geometry, up=up))
    log.info("%.2f MB", len(text) / 1e6)
    write_text(page, text)
