"""Draw the graph of the workflow's rules into docs/images: ``python docs/rule_graph.py``."""

from __future__ import annotations

import re
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import networkx as nx
from matplotlib.figure import Figure

from tusqh.figures import style

ROOT = Path(__file__).parent.parent

#: Rules to which nearly every other rule leads; without them the graph is readable.
_SINKS = ("all", "models", "crate", "results_page", "claims", "overview")

#: Colours of the files in `workflow/rules`; other files are grey.
_COLOURS = {
    "ingest": "#cde7f7",
    "sample": "#cde7f7",
    "topology": "#cde7f7",
    "mesh": "#cde7f7",
    "quality": "#d5efdc",
    "simulate": "#d5efdc",
    "tables": "#d5efdc",
    "figures": "#fbe6c2",
    "explorer": "#fbe6c2",
    "overview": "#fbe6c2",
    "theory": "#ecd9ec",
    "studies": "#ecd9ec",
    "peers": "#ecd9ec",
}


def read_rules() -> nx.DiGraph:
    """Return the graph of rules; an edge leads from the writer of a file to its reader."""
    command = [sys.executable, "-m", "snakemake", "--rulegraph"]
    dot = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    names = dict(re.findall(r'(\d+)\[label = "(\w+)"', dot))
    graph = nx.DiGraph()
    graph.add_nodes_from(names.values())
    graph.add_edges_from((names[a], names[b]) for a, b in re.findall(r"(\d+) -> (\d+)", dot))
    return graph


def home_of_rules() -> dict[str, str]:
    """Return the file in `workflow/rules` that defines each rule, without its suffix."""
    homes = {}
    for path in sorted((ROOT / "workflow/rules").glob("*.smk")):
        for name in re.findall(r"^\s*(?:use )?rule (?:\w+ as )?(\w+)", path.read_text(), re.M):
            homes[name] = path.stem
    return homes


def _place(graph: nx.DiGraph) -> dict[str, tuple[float, float]]:
    """Return the position of every rule: its generation, and a row near what it reads."""
    rows: dict[str, float] = {}
    places = {}
    for column, generation in enumerate(nx.topological_generations(graph)):
        wanted = {
            name: sum(rows[p] for p in graph.predecessors(name)) / max(graph.in_degree(name), 1)
            for name in generation
        }
        ordered = sorted(generation, key=lambda name: (wanted[name], name))
        for k, name in enumerate(ordered):
            rows[name] = k - (len(ordered) - 1) / 2
            places[name] = (column, -rows[name])
    return places


def draw_rules() -> Figure:
    """Draw the rules in columns from left to right, without edges that others imply."""
    graph = read_rules()
    graph.remove_nodes_from([name for name in _SINKS if name in graph])
    homes = home_of_rules()
    graph = nx.transitive_reduction(graph)
    places = _place(graph)
    n_columns = 1 + max(column for column, _ in places.values())
    figure, axes = style.new_figure(1, 1, width=2.0 * n_columns, height=7.5)
    axis = axes[0, 0]
    for start, end in graph.edges:
        arrow = {"arrowstyle": "-|>", "color": "#8a8a8a", "lw": 0.8, "shrinkA": 24, "shrinkB": 24}
        axis.annotate("", places[end], places[start], arrowprops=arrow)
    for name, place in places.items():
        colour = _COLOURS.get(homes.get(name, ""), "#eeeeee")
        box = {"boxstyle": "round,pad=0.35", "facecolor": colour, "edgecolor": "#555555", "lw": 0.8}
        label = "\n".join(_break(name))
        axis.text(*place, label, ha="center", va="center", fontsize=7.5, bbox=box)
    rows = [row for _, row in places.values()]
    axis.set(xlim=(-0.5, n_columns - 0.5), ylim=(min(rows) - 0.7, max(rows) + 0.7))
    axis.axis("off")
    return figure


def _break(name: str, width: int = 14) -> list[str]:
    """Return a rule's name in lines of at most about `width` characters."""
    cuts = [0]
    for found in re.finditer("_", name):
        following = name.find("_", found.end())
        if (following if following > 0 else len(name)) - cuts[-1] > width:
            cuts.append(found.end())
    return [name[a:b] for a, b in pairwise([*cuts, len(name)])]


if __name__ == "__main__":
    style.save(draw_rules(), ROOT / "docs/images/rules.png")
