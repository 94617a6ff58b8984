"""What is said from choices: what a measure saves, which one is recommended, which algorithm, and what 1 % costs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import pandas as pd

from studies.analysis.statements.record import FINDING, OPENING, Statement
from studies.experiments.choices import ALGORITHM, OFFER, PROBLEM, VARIANT, smallest
from studies.solving.choosing.trials import PATIENCE

NOISE = 0.2  # s of a solve, below which its time says nothing
SWEEP = "sweep "  # of the labels of cells that differ in one choice at a time
NODAL = "thickness_strain=nodal"
REQUEST = ["scene", "contact", "newton", "mesh", "model", "element", "section", "load", "epsilon", "tolerance"]
EXACT, LINEAR = "exact", "linear"


def cost(data_cells: pd.DataFrame) -> Iterator[Statement]:
    """What a classical measure takes over the exact one: the operations of the same request."""
    if "operations" not in data_cells:  # nothing was counted
        return
    own = data_cells[data_cells["outcome"].eq("converged") & data_cells["operations"].gt(0)]
    own = own[own["label"].str.startswith(SWEEP)].fillna(dict.fromkeys(REQUEST, ""))
    exact = own[own["measure"] == EXACT].drop_duplicates(REQUEST).set_index(REQUEST)["operations"].rename("exact")
    both = own[own["measure"] != EXACT].join(exact, on=REQUEST, how="inner")
    ratios = (both["operations"] / both["exact"]).groupby(both["measure"], sort=False)
    middle = ratios.median()
    curved = middle.drop(index=[LINEAR, "elongation"], errors="ignore")
    if curved.empty or LINEAR not in middle:
        return
    values = {"low": curved.min(), "high": curved.max(), "linear": middle[LINEAR]}
    values |= {"both": float(both["measure"].isin(curved.index).sum())}
    span = "{low:.2f} to {high:.2f}" if curved.max() - curved.min() > 0.005 else "{high:.2f}"
    text = (
        f"A nonlinear classical measure takes {span} times the operations of the exact measure in the "
        "median over {both:.0f} pairs of the same request, a linear one {linear:.2f}"
    )
    text += ", and `elongation` {elongation:.2f}" if "elongation" in middle else ""
    values |= {"elongation": middle["elongation"]} if "elongation" in middle else {}
    scope = "requests of the sweep that both solve; differences are those of the numbers of iterations"
    yield Statement("measures-cost", "measures", f"{text}.", values, len(both), scope, OPENING)


def cheapest(choices: pd.DataFrame) -> Iterator[Statement]:
    """Which measure is recommended, how often, and what 1 % costs over 5 %."""
    offers = first_offers(choices)
    if offers.empty:
        return
    asked = choices[[*PROBLEM, "asked"]].fillna("").drop_duplicates()
    names = {str(name): int(count) for name, count in offers["measure"].value_counts().items()}
    others = {name: count for name, count in names.items() if name != EXACT}
    values: dict[str, float | str] = {"asked": float(len(asked)), "answered": float(len(offers))}
    values |= {"exact": float(names.get(EXACT, 0)), "others": named_counts(others)}
    values |= {"count": float(sum(others.values()))}
    values |= {"errors": " or ".join(f"{100 * error:g} %" for error in asked["asked"].drop_duplicates())}
    text = (
        "Of {asked:.0f} questions, a problem to {errors} each, {answered:.0f} are answered; the cheapest answer takes "
        "the exact measure in {exact:.0f}"
    )
    text += " and another one in {count:.0f} ({others})." if others else "."
    scope = "the cheapest configuration that is surely within the error and certified from rest; a tie is for the exact"
    yield Statement("cheapest-measure", "measures", text, values, len(asked), scope, OPENING, machine=True)
    wide = offers.pivot_table(index=PROBLEM, columns="asked", values="seconds", sort=False)
    if wide.shape[1] < 2:
        return
    fine, coarse = min(wide.columns), max(wide.columns)
    ratio = (wide[fine] / wide[coarse])[wide[coarse] >= NOISE].dropna()
    if ratio.empty:
        return
    values = {"low": ratio.min(), "middle": ratio.median(), "high": ratio.max(), "problems": float(len(ratio))}
    values |= {"fine": f"{100 * fine:g} %", "coarse": f"{100 * coarse:g} %"}
    text = (
        "An error of {fine} takes {middle:.1f} times the seconds of {coarse} in the median, {low:.1f} to {high:.1f} on "
        "{problems:.0f} problems of {least:g} s or more. Problems without an answer to {fine}: {lost:.0f} of {all:.0f}."
    )
    values |= {"least": NOISE, "lost": float(wide[fine].isna().sum()), "all": float(len(wide))}
    scope = "configurations recommended for each, from rest"
    yield Statement("one-per-cent", "index", text, values, len(ratio), scope, FINDING, machine=True)


def nodal(choices: pd.DataFrame) -> Iterator[Statement]:
    """The thickness strain taken from the nodes alone: what it saves, and where it is lost."""
    own = pd.concat([smallest(choices, VARIANT, axis) for axis in ("measure", "element")])
    own = own[own["name"].isin([NODAL, EXACT])]
    wide = own.pivot(index=PROBLEM, columns="name", values=["seconds", "verdict"])
    if NODAL not in wide["seconds"]:
        return
    wide = wide[wide["seconds"][EXACT].notna() & wide["verdict"][NODAL].notna()]
    every = wide["seconds"].astype(float)
    ratio = (every[NODAL] / every[EXACT])[every[EXACT] >= NOISE].dropna()
    if ratio.empty:
        return
    least, most = ratio.idxmin(), ratio.idxmax()
    values: dict[str, float | str] = {"problems": float(len(ratio)), "cheaper": float((ratio < 1).sum())}
    values |= {"low": ratio.min(), "high": ratio.max(), "middle": ratio.median(), "asked": own["asked"].min()}
    values |= {
        "lost": float(every[NODAL].isna().sum()),
        "noise": NOISE,
        "least": f"`{least[0]}`",
        "most": f"`{most[0]}`",
    }
    text = (
        "`thickness_strain=nodal` reaches {asked:.0%} in {low:.2f} ({least}) to {high:.2f} ({most}) times the "
        "processor time of the default element, {middle:.2f} in the median of {problems:.0f} problems of {noise:g} s "
        "or more; it is cheaper on {cheaper:.0f} of them, and does not reach that error on {lost:.0f} more."
    )
    scope = "smallest grid surely within that error; folds of coarse meshes end at limit points of this element"
    yield Statement("nodal", "convergence", text, values, len(ratio), scope, FINDING, machine=True)


def algorithm(contact_summary: pd.DataFrame, choices: pd.DataFrame) -> Iterator[Statement]:
    """Which algorithm, and when not: those that solve all and refuse nothing, by their seconds where 1 % is reached."""
    trials = finest_trials(choices)
    default = contact_summary["default"].iloc[0] if len(contact_summary) else ""
    own = contact_summary.set_index("algorithm")
    if default not in own.index or trials.empty:
        return
    best = own.loc[[default]].to_dict("records")[0]
    values: dict[str, float | str] = {"best": f"`{default}`", "share": float(best["solved_share"])}
    values |= {"problems": float(best["problems"] - best["path_ends"]), "scenes": float(best["scenes"])}
    values |= {"refused": float(best["refused"])}
    values |= {"error": float(trials["asked"].min()), "patience": PATIENCE}
    said = []
    for n, (name, rows) in enumerate(trials[trials["name"] != default].groupby("name", sort=False)):
        over, other = rows["over"].dropna(), int(rows["other"].sum())
        values |= {f"name{n}": f"`{name}`", f"of{n}": float(len(rows)), f"solved{n}": float(len(over))}
        place = f"{{name{n}}} {{solved{n}:.0f}} of {{of{n}:.0f}}"
        if len(over):
            values |= {f"low{n}": float(over.min()), f"high{n}": float(over.max())}
            place += (
                f" at {{low{n}:.2f}} to {{high{n}:.2f}} times"
                if over.max() > 1.01 * over.min()
                else f" at {{low{n}:.2f}} times"
            )
        if other:
            values |= {f"other{n}": float(other)}
            place += f", {{other{n}:.0f}} with the penetration of its springs"
        said.append(place)
    text = (
        "Take {best}: it converges on {share:.0%} of {problems:.0f} requests over {scenes:.0f} contact scenes and "
        "refuses {refused:.0f}. On the grids that {error:.0%} takes others solve within {patience:g} times its "
        "processor time: "
    )
    scope = "from rest, judged; times of the algorithm over those of the default where both solve it"
    yield Statement(
        *("which-algorithm", "algorithms", f"{text}{'; '.join(said)}.", values, int(best["problems"]), scope, OPENING),
        machine=True,
    )


def finest_trials(choices: pd.DataFrame) -> pd.DataFrame:
    """The algorithms on the finest mesh that they were tried on, for the smallest error.

    over: time over the default's, NaN where one did not converge.  other: it converged to another answer, as one of
    springs with a finite ε does.
    """
    own = smallest(choices, ALGORITHM, ALGORITHM)
    own = own[own["verdict"] != "not tried"]
    parts = []
    for _, rows in own.groupby(PROBLEM, sort=False):
        last = rows[rows["mesh"] == rows["mesh"].iloc[-1]]
        usual = last[last["name"] == "semismooth"]["seconds"]
        converged = last["verdict"] == "converged"
        if len(usual) and converged.any():
            other = converged & (last["agrees"].astype(str) != "True")
            parts.append(last.assign(over=(last["seconds"] / usual.iloc[0]).where(converged), other=other))
    return pd.concat(parts, ignore_index=True) if parts else own.assign(over=float("nan"), other=False).iloc[:0]


def first_offers(choices: pd.DataFrame) -> pd.DataFrame:
    """What is recommended, a row a problem and error; ``measure``: its own, exact for options of the element."""
    own = choices[(choices["row"] == OFFER) & choices["mesh"].notna()]
    own = own.assign(settings=own["settings"].fillna("")).drop_duplicates([*PROBLEM, "asked"])
    return own.assign(measure=own["name"].where(own["axis"] == "measure", EXACT))


def named(names: Sequence[str]) -> str:
    """Names as code, or none."""
    return ", ".join(f"`{name}`" for name in names) or "none"


def named_counts(counts: dict[str, int]) -> str:
    """Names as code with their counts, or none."""
    return ", ".join(f"`{name}` {count}" for name, count in counts.items()) or "none"
