"""The section on where a solve spends its time: works in units of one factorisation, their parts and their bars."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from reports.figures.drawing import canvas, legend_above, looks, svg
from reports.formats import fixed, formatted, share
from reports.markdown import Part, commands, filled, joined, listing, machine, picture, prose, table
from reports.store.tables import Store

COMMAND = "footprint bench --table .footprint/store/tables/costs.csv"
PART = "part "  # of the time of a line
MUCH = 0.1  # of the time of a line: parts above it are named


def spent_part(store: Store) -> Part:
    """What ``footprint bench`` has measured; it takes a quiet machine, so no campaign measures it by itself."""
    heading = "## Where a solve spends its time"
    if not store.has_table("costs"):
        return joined(heading, machine(f"Not measured here; `{COMMAND}` does."))
    data = store.table("costs")
    parts, bars = parts_of(data), data[data["at_most"].notna()]
    ms = data.loc[data["what"] == "ms", "median"].iloc[0]
    text = prose(f"""Processor time in units of one factorisation of the tangent of the whole tyre by SuperLU, which
takes {fixed(ms)} ms here and is timed beside each work; medians of some rounds, with the lowest and the highest of all.
Solves are of the half tyre, inflated and pressed in one step, by a process that has met the grid before; *start to
files* is the whole command, a process of its own. Parts that take {share(MUCH, 0)} of a time or more:

{said_of_parts(parts)}

{said_of_bars(bars)}""")
    blocks = [_works(str(group), own) for group, own in data.groupby("group", sort=False)]
    heads = "group | line | what | is | lowest | highest | at most | bar"
    line = "{group} | `{line}` | {what} | {median:.3g} | {low:.3g} | {high:.3g} | {at_most:.3g} | {holds}"
    listed = listing("Bars", bars, heads, line, words=3)
    drawn = picture("cost-parts.svg", "Time of solves and of the command, by parts", time_by_parts(parts))
    return joined(heading, machine(text, *blocks, listed, commands([COMMAND])), drawn)


def parts_of(data: pd.DataFrame) -> pd.DataFrame:
    """Units of the parts of each line that has parts, in the order of the table; 0 where a line lacks one."""
    own = data[data["what"].str.startswith(PART)]
    found = own.assign(part=own["what"].str.removeprefix(PART)).pivot_table(
        index="line", columns="part", values="median", sort=False, fill_value=0.0
    )
    return pd.DataFrame(found)


def said_of_parts(parts: pd.DataFrame) -> str:
    """For each line its parts that take MUCH, from the largest."""
    items = []
    for line, own in parts.iterrows():
        shares = (own / own.sum()).sort_values(ascending=False, kind="stable")
        named = ", ".join(f"{part} {share(of, 0)}" for part, of in shares.items() if of >= MUCH)
        items.append(f"- `{line}`, {fixed(own.sum(), 1)} units: {named}")
    return "\n".join(items)


def said_of_bars(bars: pd.DataFrame) -> str:
    """How many hold, and by how much the others are missed."""
    broken = bars[bars["holds"] != "holds"]
    held = f"{len(bars) - len(broken)} of {len(bars)} bars hold"
    items = filled("- {group}, `{line}`: {what} {median:.3g}, at most {at_most:.3g}", broken)
    return "\n\n".join([f"{held}, but not:", "\n".join(items)]) if items else f"{held}."


def _works(group: str, own: pd.DataFrame) -> str:
    """The lines of a group side by side with all that is no bar and no part."""
    shown = own[~own["what"].str.startswith(PART) & own["at_most"].isna() | (own["what"] == "units")]
    whats = [what for what in dict.fromkeys(shown["what"]) if what != "units"]
    rows = []
    for line, each in shown.groupby("line", sort=False):
        medians: dict[object, float] = each.set_index("what")["median"].to_dict()
        units = each[each["what"] == "units"][["median", "low", "high"]].to_numpy(float)[0]
        rest = [formatted(medians.get(what), ".6g" if what == "force_N" else ".3g") for what in whats]
        rows.append([f"`{line}`", *(formatted(end, ".3g") for end in units), *rest])
    return table(group[0].upper() + group[1:], ["line", "units", "lowest", "highest", *whats], rows)


@svg
def time_by_parts(parts: pd.DataFrame) -> Figure:
    """A bar a line, its parts beside one another, the first line on top."""
    figure, (axes,) = canvas(1, width=9.0, height=1.2 + 0.36 * len(parts))
    left = pd.Series(0.0, index=parts.index)
    for part, each in looks(parts.columns).items():
        axes.barh(parts.index.to_list(), parts[part], left=left, color=each.colour, label=part)
        left = left + parts[part]
    axes.invert_yaxis()
    axes.set(xlabel="units: factorisations of the whole tyre by SuperLU")
    legend_above(figure, axes, columns=4)
    return figure
