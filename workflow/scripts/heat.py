from pathlib import Path

from provenance.record import recorded
from studies.figures.heat import draw_heat
from studies.heat import fit_orders, measure_heat
from tusqh.figures import style
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    table = measure_heat(snakemake.params.cells_2d, snakemake.params.cells_3d)
    orders = fit_orders(table)
    log.info("orders:\n%s", orders)
    write_csv(Path(snakemake.output.table), table)
    write_csv(Path(snakemake.output.orders), orders)
    style.save(draw_heat(table, orders), Path(snakemake.output.figure))
