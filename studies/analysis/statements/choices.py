"""What sentences on choices rest on: what a measure saves, which one to take, which algorithm, and what 1 % costs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import pandas as pd

from contact.catalogue import ALGORITHMS, is_exact
from studies.analysis.statements.record import Values
from studies.experiments.choices import ALGORITHM, OFFER, PROBLEM, VARIANT, smallest
from studies.solving.offers import FASTER, LOADING
from studies.solving.trials import PATIENCE

NOISE = 0.2  # s of a solve, below which its time says nothing
SWEEP = "sweep "  # of the labels of cells that differ in one choice at a time
NODAL = "thickness_strain=nodal"
REQUEST = ["scene", "contact", "newton", "mesh", "model", "element", "section", "load", "epsilon", "tolerance"]
EXACT, LINEAR, ELONGATION = "exact", "linear", "elongation"
DISTINCT = 0.005  # of ratios that are said with two digits


def cost(data_cells: pd.DataFrame) -> Iterator[Values]:
    """What a classical measure takes over the exact one: the operations of the same request."""
    if "operations" not in data_cells:  # nothing was counted
        return
    own = data_cells[data_cells["outcome"].eq("converged") & data_cells["operations"].gt(0)]
    own = own[own["label"].str.startswith(SWEEP)].fillna(dict.fromkeys(REQUEST, ""))
    exact = own[own["measure"] == EXACT].drop_duplicates(REQUEST).set_index(REQUEST)["operations"].rename("exact")
    both = own[own["measure"] != EXACT].join(exact, on=REQUEST, how="inner")
    middle = (both["operations"] / both["exact"]).groupby(both["measure"], sort=False).median()
    curved = middle.drop(index=[LINEAR, ELONGATION], errors="ignore")
    if curved.empty or LINEAR not in middle:
        return
    values: Values = {"low": curved.min(), "high": curved.max(), "linear": middle[LINEAR]}
    values["both"] = both["measure"].isin(curved.index).sum()
    if ELONGATION in middle:
        values[ELONGATION] = middle[ELONGATION]
    values |= {"_spread": int(curved.max() - curved.min() > DISTINCT), "_elongation": int(ELONGATION in middle)}
    yield values | {"_problems": len(both)}


def cheapest(choices: pd.DataFrame) -> Iterator[Values]:
    """Which measure is recommended, and how often."""
    offers = first_offers(choices)
    if offers.empty:
        return
    asked = choices[[*PROBLEM, "asked"]].fillna("").drop_duplicates()
    names = {str(name): int(count) for name, count in offers["measure"].value_counts().items()}
    exact = names.pop(EXACT, 0)
    values: Values = {"asked": len(asked), "answered": len(offers), "exact": exact, "others": named_counts(names)}
    least = LOADING * (1 - FASTER) / FASTER  # s, which to spare altogether would not be enough
    values |= {"quick": (offers["seconds"] < least).sum(), "least": least}
    errors = " or ".join(f"{100 * error:g} %" for error in asked["asked"].drop_duplicates())
    yield values | {"count": sum(names.values()), "errors": errors, "_problems": len(asked)}


def one_per_cent(choices: pd.DataFrame) -> Iterator[Values]:
    """What the smallest error asked for costs over the largest one."""
    offers = first_offers(choices)
    wide = offers.pivot_table(index=PROBLEM, columns="asked", values="seconds", sort=False)
    if wide.shape[1] < 2:
        return
    fine, coarse = min(wide.columns), max(wide.columns)
    ratio = (wide[fine] / wide[coarse])[wide[coarse] >= NOISE].dropna()
    if ratio.empty:
        return
    values: Values = {"low": ratio.min(), "middle": ratio.median(), "high": ratio.max(), "problems": len(ratio)}
    values |= {"fine": f"{100 * fine:g} %", "coarse": f"{100 * coarse:g} %", "least": NOISE}
    yield values | {"lost": wide[fine].isna().sum(), "all": len(wide), "_problems": len(ratio)}


def nodal(choices: pd.DataFrame) -> Iterator[Values]:
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
    values: Values = {"problems": len(ratio), "cheaper": (ratio < 1).sum(), "low": ratio.min(), "high": ratio.max()}
    values |= {"middle": ratio.median(), "asked": own["asked"].min(), "lost": every[NODAL].isna().sum()}
    values |= {"noise": NOISE, "least": f"`{ratio.idxmin()[0]}`", "most": f"`{ratio.idxmax()[0]}`"}
    yield values | {"_problems": len(ratio)}


def algorithm(contact_summary: pd.DataFrame, choices: pd.DataFrame) -> Iterator[Values]:
    """The default algorithm: how often it converges, and seconds of the others over its own on grids for 1 %."""
    trials = finest_trials(choices)
    default = contact_summary["default"].iloc[0] if len(contact_summary) else ""
    own = contact_summary.set_index("algorithm")
    if default not in own.index or trials.empty:
        return
    best = own.loc[[default]].to_dict("records")[0]
    values: Values = {"best": f"`{default}`", "share": best["solved_share"], "noise": NOISE, "patience": PATIENCE}
    values |= {"problems": best["problems"] - best["path_ends"], "scenes": best["scenes"], "refused": best["refused"]}
    others = own["solved_share"].drop(default)
    values |= {"_others": len(others), "least": others.min(), "most": others.max(), "error": trials["asked"].min()}
    clauses, springs = [], {each for each in ALGORITHMS if not is_exact(each)}
    for n, (name, rows) in enumerate(trials[trials["name"] != default].groupby("name", sort=False)):
        long = rows[rows["usual"] >= NOISE]
        if long.empty:
            continue
        over, other = long["over"].dropna(), int(long["other"].sum())
        values |= {f"name{n}": f"`{name}`", f"of{n}": len(long), f"solved{n}": len(over)}
        place = f"{{name{n}}} {{solved{n}:.0f}} of {{of{n}:.0f}}"
        if len(over):
            values |= {f"low{n}": over.min(), f"high{n}": over.max()}
            span = f" to {{high{n}:.2f}}" if over.max() > 1.01 * over.min() else ""
            place += f" at {{low{n}:.2f}}{span} times"
        if other:
            values[f"other{n}"] = other
            place += f", {{other{n}:.0f}} of them with another answer"
            place += ", that of a finite ε" if name in springs else ""
        clauses.append(place)
    yield values | {"_told": "; ".join(clauses), "_problems": best["problems"]}


def finest_trials(choices: pd.DataFrame) -> pd.DataFrame:
    """The algorithms on the finest mesh that they were tried on, for the smallest error.

    usual: seconds of the default.  over: time over that, NaN where one did not converge.  other: it converged to
    another answer, as one of springs with a finite ε does.
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
            over = (last["seconds"] / usual.iloc[0]).where(converged)
            parts.append(last.assign(usual=usual.iloc[0], over=over, other=other))
    if not parts:
        return own.assign(usual=float("nan"), over=float("nan"), other=False).iloc[:0]
    return pd.concat(parts, ignore_index=True)


def first_offers(choices: pd.DataFrame) -> pd.DataFrame:
    """What is recommended, a row a problem and error; ``measure``: its own, exact for options of the element."""
    own = choices[(choices["row"] == OFFER) & choices["mesh"].notna()]
    own = own.assign(settings=own["settings"].fillna("")).drop_duplicates([*PROBLEM, "asked"])
    return own.assign(measure=own["name"].where(own["axis"] == "measure", EXACT))


def named_counts(counts: Mapping[str, int]) -> str:
    """Names as code with their counts, or none."""
    return ", ".join(f"`{name}` {count}" for name, count in counts.items()) or "none"
