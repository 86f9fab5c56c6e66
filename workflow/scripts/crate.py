import shutil
from pathlib import Path

from provenance.crate import make_crate, select_records
from provenance.crate_ids import ROOT
from provenance.environment import installed_versions
from provenance.record import recorded
from provenance.stored import read_records
from tusqh.atomic import replacing, write_text
from tusqh.hashing import canonical_json

with recorded(snakemake) as log:
    copies = [Path(path) for path in snakemake.output.workflow]
    checkout = Path(snakemake.scriptdir).resolve().parents[1]
    for copy in copies:
        with replacing(copy) as temporary:
            shutil.copyfile(checkout / copy.relative_to(ROOT / "workflow"), temporary)
    records = select_records(read_records(), snakemake.input.results)
    crate = make_crate(
        records,
        about=snakemake.params.about,
        register=snakemake.params.register,
        workflow_files=[copy.relative_to(ROOT).as_posix() for copy in copies],
        engine_version=installed_versions()["snakemake"],
    )
    log.info("%d steps, %d entities", len(records), len(crate["@graph"]))
    write_text(Path(snakemake.output.crate), canonical_json(crate))
