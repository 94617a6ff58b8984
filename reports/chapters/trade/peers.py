"""Part of the page of cost: other programs on the same problems, work against precision."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from reports.figures.drawing import BLACK, canvas, lines, svg
from reports.formats import fixed, number, share
from reports.markdown import Part, commands, joined, listing, machine, picture, prose
from reports.store.tables import Store

LEAST = 1e-5  # below it an error is chance
OURS = "footprint"
COMMAND = "footprint bench peers --table .footprint/store/tables/peers.csv"
HEADING = "## Beside other programs"
PARTS = {"start": "mesh and start", "assembly": "elements", "factorisation": "factorisation"}


def peers_part(store: Store) -> Part:
    """Shells beside other programs; it takes those programs, so no campaign measures it by itself."""
    if not (store.has_table("peers") and store.has_analysis("peer_factors")):
        return joined(HEADING, machine(f"Not measured here; `{COMMAND}` does, with the extra peers."))
    measured, factors = store.table("peers"), store.analysis("peer_factors").fillna({"mesh": ""})
    text = prose("""The same geometry, material and loads by other programs, a line of meshes for each of their elements
or orders: NGSolve's hexahedra on the tyre, a quarter of it where the plies have mirror planes and the whole where they
have not; Kratos' corotational shells, with the fewest equal load steps from which its Newton-Raphson strategy arrives.
Processor time of one thread from the request to the value, medians of rounds in one run; a *unit* is one factorisation
by SuperLU of the whole tyre on 42x40, 9840 unknowns. Errors are against references that are not ours: the finest
solids of NGSolve for tyres, the published table for the hemisphere and the cylinder, the elastica for the cantilever.
A mesh is *sufficient* when it and all finer ones of its line are within the error asked for. *Apart*: the value of the
line's finest mesh over that of our cheapest line. Meshes of solids count a quarter where a quarter is solved, those of
shells the whole tyre. *The rest* of our time: contact, triangular solutions, the judge, and what Python takes between
them. The cylinder snaps at half of its load: shells follow it by arc length through both limit points, Kratos' load
steps jump over them.""")
    said = "\n".join(f"- {sentence}" for sentence in sentences(factors))
    heads = "problem | program | line | within | sufficient | unknowns | off | seconds | units | factor | apart"
    line = "{problem} | `{program}` | {family} | {within:said} | {mesh:said} | {unknowns:.0f} | {error:+.2%} | "
    line += "{seconds:.2f} | {units:.1f} | {factor:.1f} | {apart:+.2%}"
    need = listing("What it takes", factors, heads, line, words=3, said=_said)
    every = "problem | program | line | mesh | unknowns | value | off | iterations | seconds | units"
    row = "{problem} | `{program}` | {family} | {mesh} | {unknowns:.0f} | {value:.5g} | {error:+.2%} | "
    row += "{iterations:.0f} | {seconds:.3f} | {units:.2f}"
    all_of_it = listing("All meshes", measured, every, row, words=4)
    drawn = picture(
        "cost-peers.svg", "Error over processor time, by problem, program and line", work_precision(measured)
    )
    body = machine(text, said, need, drawn.text, all_of_it, commands([COMMAND]))
    return joined(HEADING, Part(body, drawn.pictures))


def _said(value: object) -> str:
    return f"{number(100 * value)} %" if isinstance(value, float) else str(value or "–")


def sentences(factors: pd.DataFrame) -> list[str]:
    """Of each problem and peer: how many times our time it takes, whether that is the bar, and where time goes."""
    said = []
    for problem, own in factors.groupby("problem", sort=False):
        ours = own[(own["program"] == OURS) & own["cheapest"]]
        for program, lines_of in own[own["program"] != OURS].groupby("program", sort=False):
            best = lines_of[lines_of["cheapest"]]
            within = share(float(own["within"].iloc[0]))
            if ours.empty or best.empty:
                who = " nor ".join(f"`{name}`" for name, of in ((OURS, ours), (program, best)) if of.empty)
                said.append(f"{problem}, within {within}: no line of {who} gets and stays there.")
            else:
                told = _compared(str(program), ours.iloc[0], best.iloc[0])
                said.append(f"{problem}, within {within}: {told}{_others(lines_of[~lines_of['cheapest']])}")
    return said


def _compared(program: str, ours: pd.Series, peer: pd.Series) -> str:
    took = f"`{program}` ({peer['family']}, {peer['mesh']}) takes {fixed(peer['factor'], 1)} times the time of "
    took += f"`{OURS}` ({ours['family']}, {ours['mesh']})"
    bar = peer["bar"]
    if pd.isna(bar):
        return f"{took}."
    if peer["factor"] >= bar:
        return f"{took}; the bar of {number(bar)} is met."
    floor = "would be met" if peer["bare"] >= bar else "would be missed"
    return (
        f"{took}; the bar of {number(bar)} is missed. Time goes to {_shares(ours)} in `{OURS}`, to {_shares(peer)} in "
        f"`{program}`. The floor of `{OURS}` on this mesh is its factorisations: with nothing else the factor would be "
        f"{fixed(peer['bare'], 1)}, and the bar {floor}."
    )


def _others(lines_of: pd.DataFrame) -> str:
    """The factors of the lines that are not the cheapest of their program."""
    there = lines_of[lines_of["factor"].notna()].sort_values("factor", kind="stable")
    listed = ", ".join(f"{row['family']} {fixed(row['factor'], 1)}" for row in there.to_dict("records"))
    return f" Its other lines: {listed} times." if listed else ""


def _shares(line: pd.Series) -> str:
    parts = {text: float(line[f"share_{part}"]) for part, text in PARTS.items()}
    parts["the rest"] = 1 - sum(parts.values())
    ordered = sorted(parts.items(), key=lambda item: -item[1])
    return ", ".join(f"{text} {round(100 * value)} %" for text, value in ordered)


@svg
def work_precision(data: pd.DataFrame) -> Figure:
    """Error over units, a panel a problem; dotted what is asked for, grey below what the reference is known to."""
    groups = data.groupby("problem", sort=False)
    figure, panels = canvas(len(groups), columns=2, width=11.0, height=4.6)
    for axes, (problem, own) in zip(panels, groups, strict=True):
        own = own.assign(error=own["error"].abs().clip(lower=LEAST))
        named = own.groupby(["program", "family"], sort=False)
        lines(axes, {", ".join(map(str, key)): (each["units"], each["error"]) for key, each in named})
        axes.axhline(own["within"].iloc[0], color=BLACK, linewidth=1, linestyle=":")
        axes.axhspan(LEAST / 2, max(own["uncertainty"].iloc[0], LEAST / 2), color=BLACK, alpha=0.08, linewidth=0)
        axes.set(title=str(problem), xlabel="processor time [factorisations of 9840 unknowns]", ylabel="relative error")
        axes.set(xscale="log", yscale="log", ylim=(LEAST / 2, None))
        axes.legend(fontsize="small")
    return figure
