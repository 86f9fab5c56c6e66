from pathlib import Path

from provenance.record import recorded
from studies.figures.fit_convergence import draw_convergence
from studies.fit_convergence import find_orders, measure_convergence
from tusqh.figures import style
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    table = measure_convergence(snakemake.params.surfaces, snakemake.params.cells)
    orders = find_orders(table)
    log.info("orders:\n%s", orders)
    write_csv(Path(snakemake.output.table), table)
    write_csv(Path(snakemake.output.orders), orders)
    style.save(draw_convergence(table, orders), Path(snakemake.output.figure))
