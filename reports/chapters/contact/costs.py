"""What a solve in contact costs by algorithm: a table and a picture of the same rows of the table ``choices``.

Which mesh an error takes was decided where that was made.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import prod

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, NullLocator

from reports.chapters.overview.decision import CHOICES, PROBLEM, problem
from reports.figures.drawing import GREY, canvas, legend_above, looks, svg
from reports.formats import code, digits, share
from reports.markdown import Part, by_name, table
from reports.store.tables import Store
from reports.template import Template

TEXT = Template("algorithms")
USUAL, CONVERGED = "semismooth", "converged"
NOT_SOLVED = ("refused", "not tried")  # verdicts without seconds of their own


def costs_part(store: Store) -> Part:
    """What they cost, under its heading."""
    data = _solves(store)
    if data.empty:
        return Part()
    errors = " and of ".join(share(error, 0) for error in sorted(data["asked"].unique(), reverse=True))
    names = sorted(dict.fromkeys(data["name"]), key=lambda name: name != USUAL)
    meshes = (((problem(first), first["mesh"]), tried) for first, tried in _meshes(data))
    rows = by_name(meshes, names, _spent)
    shown = table("Seconds and iterations by algorithm and mesh", ["problem", "mesh", *map(code, names)], rows, words=2)
    return TEXT("costs", errors=errors, rules=store.rules(), table=shown)


def costs_picture(store: Store) -> Part:
    """Who solves what at which cost."""
    data = _solves(store)
    if data.empty:
        return Part()
    return TEXT("costs-picture", {"index-algorithms.svg": seconds_by_algorithm(data)}, rules=store.rules())


def _solves(store: Store) -> pd.DataFrame:
    data = store.rows(CHOICES)
    own = data[data["row"] == "algorithm"] if len(data) else data
    return own.drop_duplicates([*PROBLEM, "mesh", "name"], keep="last") if len(own) else own


def _meshes(data: pd.DataFrame) -> Iterator[tuple[dict, pd.DataFrame]]:
    """The solves of each problem on each of its meshes, the coarsest first, behind the first of them."""
    data = data.assign(elements=[prod(map(int, mesh.split("x"))) for mesh in data["mesh"]])
    for _, solved in data.groupby(PROBLEM, sort=False):
        for _, tried in solved.groupby("elements"):
            yield tried.iloc[0].to_dict(), tried


def _spent(row: dict) -> str:
    if row["verdict"] != CONVERGED:
        return str(row["verdict"])
    return f"{digits(row['seconds'], 2)} ({row['iterations']:.0f})"


@svg
def seconds_by_algorithm(data: pd.DataFrame) -> Figure:
    """A line a problem and mesh, a mark an algorithm, hollow where it did not converge in time."""
    lines = [(first, tried.set_index("name")) for first, tried in _meshes(data)]
    lines = [(first, tried) for first, tried in lines if tried["verdict"].get(USUAL) == CONVERGED]
    looked = looks(name for name in dict.fromkeys(data["name"]) if name != USUAL)
    figure, (axes,) = canvas(width=8.0, height=1.2 + 0.38 * len(lines), head=0.6)
    labels = []
    for place, (first, tried) in enumerate(lines):
        usual = tried["seconds"][USUAL]
        settings = f" {first['settings']}" if first["settings"] else ""
        labels.append(f"{first['scene']}{settings}\n{first['mesh']}, {digits(usual, 2)} s")
        for rank, (name, style) in enumerate(looked.items()):
            if name not in tried.index:
                continue
            own, height = tried.loc[name], place + 0.12 * (rank - (len(looked) - 1) / 2)
            if own["verdict"] not in NOT_SOLVED:
                face = style.colour if own["verdict"] == CONVERGED else "none"
                axes.plot([own["seconds"] / usual], [height], linestyle="", **style.points, markerfacecolor=face)
    for name, style in looked.items():
        axes.plot([], [], linestyle="", **style.points, label=name)
    axes.axvline(1.0, color=GREY, linewidth=1.0)
    axes.set(xscale="log", xlabel=f"seconds over those of {USUAL}", ylim=(len(lines) - 0.5, -0.5))
    axes.set_yticks(range(len(lines)), labels, fontsize=8)
    axes.set_xticks([0.5, 0.7, 1.0, 1.4, 2.0], ["0.5", "0.7", "1", "1.4", "2"])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_minor_formatter(NullFormatter())
    legend_above(figure, axes, columns=3)
    return figure
