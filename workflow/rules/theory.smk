# The paper's claims about pinches, gaps and refinement; figures are drawn from the tables alone.


rule pinch_catalogue:
    output:
        catalogue=report("results/tables/pinches.csv", "../report/pinch_catalogue.rst", category="Theory"),
        elements="results/tables/pinch_elements.csv",
        series="results/tables/pinch_series.csv",
        series_shapes="results/tables/pinch_series_shapes.csv",
        edges="results/tables/connecting_edges.csv",
        edges_shapes="results/tables/connecting_edges_shapes.csv",
    script:
        "../scripts/pinch_catalogue.py"


rule figure_pinches:
    input:
        catalogue="results/tables/pinches.csv",
        elements="results/tables/pinch_elements.csv",
        series="results/tables/pinch_series.csv",
        series_shapes="results/tables/pinch_series_shapes.csv",
        edges="results/tables/connecting_edges.csv",
        edges_shapes="results/tables/connecting_edges_shapes.csv",
    output:
        catalogue=report("results/figures/pinches.png", "../report/pinches.rst", category="Theory"),
        series=report("results/figures/pinches_in_series.png", "../report/pinches_in_series.rst", category="Theory"),
        edges=report("results/figures/connecting_edges.png", "../report/connecting_edges.rst", category="Theory"),
    script:
        "../scripts/figure_pinches.py"


rule aliasing:
    output:
        examples=report("results/tables/aliasing.csv", "../report/aliasing_table.rst", category="Theory"),
        shapes="results/tables/aliasing_shapes.csv",
        axis_gap="results/tables/axis_gap.csv",
        axis_gap_shapes="results/tables/axis_gap_shapes.csv",
    params:
        offsets=60,
    script:
        "../scripts/aliasing.py"


rule figure_aliasing:
    input:
        examples="results/tables/aliasing.csv",
        shapes="results/tables/aliasing_shapes.csv",
        axis_gap="results/tables/axis_gap.csv",
        axis_gap_shapes="results/tables/axis_gap_shapes.csv",
    output:
        examples=report("results/figures/aliasing.png", "../report/aliasing.rst", category="Theory"),
        axis_gap=report("results/figures/axis_gap.png", "../report/axis_gap.rst", category="Theory"),
    script:
        "../scripts/figure_aliasing.py"


rule theorem_plane:
    output:
        orientations="results/tables/theorem_orientations.csv",
        sweep="results/tables/theorem_sweep.csv",
        windows=report("results/tables/theorem_windows.csv", "../report/theorem_windows.rst", category="Theory"),
        contradictions=report(
            "results/tables/theorem_contradictions.csv", "../report/theorem_contradictions.rst", category="Theory"
        ),
    params:
        rotation_step=0.5,
        offsets=64,
        widths=[0.3, 1.5, 0.01],
    threads: 2
    script:
        "../scripts/theorem_plane.py"


rule theorem_space:
    output:
        orientations="results/tables/theorem_space_orientations.csv",
        sweep="results/tables/theorem_space_sweep.csv",
        windows=report("results/tables/theorem_space_windows.csv", "../report/theorem_windows.rst", category="Theory"),
    params:
        ratios=12,
        offsets=16,
        widths=[0.3, 2.1, 0.05],
    threads: 2
    script:
        "../scripts/theorem_space.py"


rule gap_meshes:
    output:
        table=report("results/tables/gap_meshes.csv", "../report/gap_meshes.rst", category="Theory"),
    params:
        trials=100,
        samples=[0, 2, 4, 8],
        seed=7,
    script:
        "../scripts/gap_meshes.py"


rule figure_theorem:
    input:
        orientations="results/tables/theorem_orientations.csv",
        sweep="results/tables/theorem_sweep.csv",
        windows="results/tables/theorem_windows.csv",
        space_orientations="results/tables/theorem_space_orientations.csv",
        space_windows="results/tables/theorem_space_windows.csv",
    output:
        map=report("results/figures/theorem_map.png", "../report/theorem_map.rst", category="Theory"),
        windows=report("results/figures/theorem_windows.png", "../report/theorem_ends.rst", category="Theory"),
        space=report("results/figures/theorem_space.png", "../report/theorem_space.rst", category="Theory"),
    script:
        "../scripts/figure_theorem.py"


rule refinement:
    output:
        two_triangles=report("results/tables/two_triangles.csv", "../report/two_triangles_table.rst", category="Theory"),
        two_triangles_shapes="results/tables/two_triangles_shapes.csv",
        wedge_components="results/tables/wedge_components.csv",
        wedge_grids=report("results/tables/wedge_grids.csv", "../report/wedge_table.rst", category="Theory"),
    params:
        refinements=10,
        halvings=5,
    script:
        "../scripts/refinement.py"


rule figure_refinement:
    input:
        two_triangles="results/tables/two_triangles.csv",
        two_triangles_shapes="results/tables/two_triangles_shapes.csv",
        wedge_components="results/tables/wedge_components.csv",
        wedge_grids="results/tables/wedge_grids.csv",
    output:
        two_triangles=report("results/figures/two_triangles.png", "../report/two_triangles.rst", category="Theory"),
        wedge=report("results/figures/wedge_islands.png", "../report/wedge_islands.rst", category="Theory"),
    script:
        "../scripts/figure_refinement.py"


rule layers:
    output:
        table=report("results/tables/layers.csv", "../report/layers.rst", category="Theory"),
    script:
        "../scripts/layers.py"
