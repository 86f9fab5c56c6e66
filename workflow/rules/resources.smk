# The memory and time that a step may take, for clusters and for `--resources mem_mb=8000` on one machine:
# at least twice what the records of the default configuration state, and more with the cells of the
# model's grid. A step that is killed for one of them is tried again with as much more, see ../../profiles/slurm.
import math

from snakemake.resources import Resources

from tusqh.sampling.memory import estimate_memory, estimate_slab, estimate_slabs

# Megabytes and minutes of a step of a small model: libraries, and the allowance of the scheduler.
SMALLEST = 1500, 10
# Multiples of the memory that `tusqh.mesh` needs at a threshold, and minutes for a million cells of the
# grid, where steps differ from the others.
MEMORY_OF_RULES = {"simulate": 9, "simulate_materials": 9, "materials": 7, "suitability": 18, "peer": 9}
MEMORY_OF_OTHERS = 2.2
MINUTES_OF_RULES = {
    **dict.fromkeys(["sweep_2d", "sweep_3d", "sweep_one", "figures_of_outline", "figures_of_solid"], 10),
    **dict.fromkeys(["simulate", "simulate_materials", "suitability", "materials", "peer"], 30),
}
RULES_OF_ONE_SLAB = {"slab_sample", "slab_elements", "slab_piece"}
# Minutes of steps over all models, of which the grids are fixed or small.
MINUTES_ALONE = {"theorem_plane": 30, "theorem_space": 30, "gap_meshes": 30, "slow_tests": 240, "placements": 60, "placements_part": 60}


def cells_of(model, dimension):
    """Return about how many cells the grid of a model has, at most where it is given by `cells`."""
    grid, window = model.settings.grid, model.settings.window
    if grid.cell_size is not None:
        # The box of a geometry is not known before it is read.
        sizes = grid.cell_size if isinstance(grid.cell_size, tuple) else dimension * (grid.cell_size,)
        lower, upper = window.box if window else ([0] * dimension, [100 * size for size in sizes])
        return math.prod(math.ceil((b - a) / size) for a, b, size in zip(lower, upper, sizes))
    cells = grid.cells or 64
    return math.prod(cells) if isinstance(cells, tuple) else cells**dimension


def memory_of(rule):
    """Return the function that gives a rule its megabytes."""

    def memory(wildcards, attempt):
        smallest = SMALLEST[0] * attempt
        if "model" not in wildcards.keys():
            return smallest
        model = SETTINGS.models[wildcards.model]
        dimension = dimension_of(model.files[0])
        n_cells = cells_of(model, dimension)
        if wildcards.model in IN_SLABS:
            return attempt * math.ceil(1.3 * memory_in_slabs(rule, n_cells, slabs_of(wildcards)) / 1e6) + smallest
        needed = estimate_memory(n_cells, n_cells, dim=dimension) * MEMORY_OF_RULES.get(rule, MEMORY_OF_OTHERS)
        return smallest + attempt * math.ceil(1.3 * needed / 1e6)

    return memory


def memory_in_slabs(rule, n_cells, n_slabs):
    """Return the bytes of a step of a model in slabs, of one slab or of the whole grid."""
    estimate = estimate_slab if rule in RULES_OF_ONE_SLAB else estimate_slabs
    return estimate(n_cells, n_cells, n_slabs)


def minutes_of(rule):
    """Return the function that gives a rule its minutes."""

    def minutes(wildcards, attempt):
        if "model" not in wildcards.keys():
            return attempt * MINUTES_ALONE.get(rule, SMALLEST[1])
        model = SETTINGS.models[wildcards.model]
        millions = cells_of(model, dimension_of(model.files[0])) / 1e6
        return attempt * math.ceil(MINUTES_ALONE.get(rule, SMALLEST[1]) + MINUTES_OF_RULES.get(rule, 3) * millions)

    return minutes


for step in workflow.modifier.rules:
    if Path(step.snakefile).is_relative_to(BASE) and (step.script or step.shellcmd):
        needs = {"mem_mb": memory_of(step.name), "runtime": minutes_of(step.name)}
        step.resources.update(Resources.from_mapping(needs))
