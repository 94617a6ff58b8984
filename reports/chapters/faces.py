"""The page of two deformable faces: pairings and slaves beside known values, algorithms, what an iteration costs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from reports.chapter import chapter
from reports.figures.drawing import canvas, legend_above, look, svg, ticks
from reports.formats import NOTHING, code, quantity, scientific, share
from reports.markdown import Part, Template, by_name, commands, table
from reports.store import Store

TEXT = Template("faces")
TABLES = ("faces", "faces_algorithms", "faces_cost", "faces_spheres", "faces_ironing")
KINDS = (("mortar", "first"), ("mortar", "second"), ("nodes", "first"), ("nodes", "second"))
SOLVED = ("converged", "unstable")
COLUMNS = 4


def faces_page(store: Store) -> Part:
    """The whole page."""
    readings, run, cost, spheres, ironed = map(store.table, TABLES)
    readings = readings.assign(solved=readings["outcome"].isin(SOLVED))
    requests = readings.drop_duplicates("command")
    values: dict[str, Any] = {
        "meshes": int(readings.groupby("problem")["mesh"].nunique().max()),
        "errors": list(_errors(readings)),
        "asked": int((requests["pairing"] == "mortar").sum()),
        "odd": _short(requests[~requests["solved"]]),
        "commands": commands(requests.loc[requests["finest"].astype(bool), "command"]),
        **{each: int(requests.loc[requests["pairing"] == each, "solved"].sum()) for each in ("mortar", "nodes")},
    }
    names = list(dict.fromkeys(run["algorithm"]))
    usual = run["case"].map(run[run["algorithm"] == names[0]].set_index("case")["substeps"])
    run = run.assign(usual=usual)
    rows = by_name((([case], own) for case, own in run.groupby("case", sort=False)), names, _cell, "algorithm")
    values["cases"] = table("Against `semismooth`", ["problem", *map(code, names)], rows, words=1)
    values["failed"] = _short(run[~run["outcome"].isin(SOLVED)])
    values |= {"costs": list(_costs(cost)), "spheres": list(_spheres(spheres)), **_ironed(ironed)}
    return TEXT("page", {"faces.svg": errors(readings)}, **values)


def _short(rows: pd.DataFrame) -> pd.DataFrame:
    """With the first clause of their reasons."""
    return rows.assign(reason=rows["reason"].astype(str).str.split("; ").str[0])


def _errors(rows: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """A row a problem and quantity: the error on the finest mesh and its order, by pairing and slave."""
    for (problem, name), own in rows.groupby(["problem", "quantity"], sort=False):
        row = {"problem": problem, "quantity": name, "mesh": own["mesh"].iloc[-1]}
        row["known"] = share(own["known"].iloc[0]) if own["known"].iloc[0] else NOTHING
        for pairing, slave in KINDS:
            mine = own[(own["pairing"] == pairing) & (own["slave"] == slave)]
            row[f"{pairing}_{slave}"] = _error(mine) if len(mine) else NOTHING
        yield row


def _error(mine: pd.DataFrame) -> str:
    """Of the last mesh, with the order since the first; what is rounding, or below the reference's own, has none."""
    first, last = mine["error"].abs().iloc[0], mine["error"].iloc[-1]
    if not mine["solved"].iloc[-1]:
        return str(mine["outcome"].iloc[-1])
    if abs(last) < 1e-9:
        return scientific(last)
    seen = mine["solved"].iloc[0] and abs(last) > mine["known"].iloc[-1]
    order = f" ({math.log2(first / abs(last)) / (len(mine) - 1):.1f})" if seen else ""
    return share(last) + order


def _spheres(spheres: pd.DataFrame) -> Iterator[dict[str, str]]:
    """What the codes have, and a row a mesh on facets and on curved faces, a column a travel."""
    codes = spheres.drop_duplicates("delta_mm")
    band = zip(codes["delta_mm"], codes["reference"], codes["known"], strict=True)
    yield {"faces": "published codes", "mesh": "", "ended": ""} | {
        f"at_{delta:g}": f"{value:.3f} ± {share(known)}" for delta, value, known in band
    }
    for (faces, mesh), own in spheres.groupby(["faces", "mesh"], sort=False):
        readings = zip(own["delta_mm"], own["quarter_N"], strict=True)
        forces = {f"at_{delta:g}": NOTHING if math.isnan(force) else f"{force:.4f}" for delta, force in readings}
        ended = f"{own['outcome'].iloc[0]} ({own['iterations'].iloc[0]:.0f})"
        yield {"faces": code(str(faces)), "mesh": str(mesh), "ended": ended, **forces}


def _ironed(ironed: pd.DataFrame) -> dict[str, Any]:
    """The meshes; what H/V changes by between the last two of solids, and at most by the other slab."""
    before, last = (row for _, row in ironed[ironed["slab"] == "solid"].iloc[-2:].iterrows())
    by_slab = ironed.pivot(index="mesh", columns="slab", values="ratio").dropna()
    values = {"changed": abs(last["ratio"] / before["ratio"] - 1), "ripple": last["ripple"] / last["ratio"]}
    values["apart"] = float((by_slab["shell"] / by_slab["solid"] - 1).abs().max())
    return {"ironed": ironed, "coarser": before["mesh"], "finer": last["mesh"], **values}


def _cell(row: dict[str, Any]) -> str:
    if row["outcome"] not in SOLVED:
        return str(row["outcome"])
    steps = "" if row["substeps"] == row["usual"] else f", {row['substeps']:.0f} steps for {row['usual']:.0f}"
    return f"{scientific(row['force_error'])} ({row['iterations']:.0f}{steps})"


def _costs(cost: pd.DataFrame) -> Iterator[dict[str, float]]:
    """A row a size: that of the ring on a plane comes first."""
    plane, *others = (own for _, own in cost.groupby("pairing", sort=False))
    for row in plane.to_dict("records"):
        ratios = {own["pairing"].iloc[0]: own.loc[own["size"] == row["size"], "ratio"].iloc[0] for own in others}
        yield {"unknowns": row["unknowns"], "plane": 1e3 * row["cpu_s"], **ratios}


@svg
def errors(rows: pd.DataFrame) -> Figure:
    """A panel a problem and quantity, errors over elements along a face; none of requests without an answer."""
    solved = rows[rows["outcome"].isin(SOLVED)]
    groups = list(solved.groupby(["problem", "quantity"], sort=False))
    figure, panels = canvas(len(groups), COLUMNS, width=11.0, height=2.3, head=0.4)
    for axes, ((problem, name), own) in zip(panels, groups, strict=True):
        for number, (pairing, slave) in enumerate(KINDS):
            mine = own[(own["pairing"] == pairing) & (own["slave"] == slave)]
            elements = mine["mesh"].str.split("x").str[-1].astype(int)
            axes.loglog(elements, mine["error"].abs(), label=f"{pairing}, {slave} as slave", **look(number).whole)
        axes.yaxis.set_minor_formatter("")
        ticks(axes, sorted(own["mesh"].str.split("x").str[-1].astype(int).unique()))
        title = "\n".join([*str(problem).split(", "), quantity(str(name))])
        axes.set(title=title, xlabel="elements")
    legend_above(figure, panels[0])
    return figure


CHAPTER = chapter(TEXT, faces_page, needs=TABLES)
