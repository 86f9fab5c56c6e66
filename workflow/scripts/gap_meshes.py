from pathlib import Path

import numpy as np
import pandas as pd

from provenance.record import recorded
from studies.gap_meshes import compare_with_meshes
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    trials, seed = snakemake.params.trials, snakemake.params.seed
    table = pd.concat(
        compare_with_meshes(trials, samples, np.random.default_rng(seed))
        for samples in snakemake.params.samples
    )
    write_csv(Path(snakemake.output.table), table)
    log.info("%d of %d meshes agree with the filtration", table["agrees"].sum(), len(table))
