"""The answers of page one, each a section of sentences and a small table; what a campaign cannot say is left out."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import pandas as pd

from reports.formats import NOTHING, code, digits, fixed, formatted, share
from reports.markdown import Part, commands, folded, joined, listing, machine, prose, table
from reports.store.statements import sentence, statements
from reports.store.tables import Store

EXACT = "exact"
OVER = "seconds_over_default"
TOLD = (0.05, 0.01, 0.002)  # errors that page one prices
PLURAL = {"roof-d": "a roof"}


def answers(store: Store) -> list[Part]:
    """The sections that this campaign can fill."""
    found = [section(store) for section in SECTIONS]
    return [part for part in found if part.text.strip()]


def _section(title: str, store: Store, names: tuple[str, ...], *parts: str, more: str = "") -> Part:
    """Sentences by their names, in order, times marked as the machine's; nothing where there is none of them."""
    by_name = {each.name: each for each in statements(store)}
    said = [by_name[name] for name in names if name in by_name]
    if not said:
        return Part("")
    steady = " ".join(each.text for each in said if not each.machine)
    timed = " ".join(each.text for each in said if each.machine)
    blocks = [prose(steady) if steady else "", machine(prose(timed)) if timed else ""]
    return joined(f"## {title}", *blocks, *parts, more)


def _strains(store: Store) -> Part:
    regimes = ("measures-shallow", "measures-tyre", "measures-ring", "measures-large")
    names = (*regimes, "measures-cost", "equal-error", "tyre-measure", "tyre-measure-saves")
    more = "[More: strain measures](measures.md), [which do not get there](outcomes.md)"
    return _section("Exact or classical strains?", store, names, regimes_table(store), more=more)


def regimes_table(store: Store) -> str:
    """A row a measure: the largest error and the seconds over the exact measure in each regime."""
    if not store.has_analysis("regimes"):
        return ""
    data = store.analysis("regimes")
    data = data[data["scene"] == ""]
    names = list(dict.fromkeys(data["regime"]))
    measures = [name for name in dict.fromkeys(data["measure"]) if name != EXACT]
    crossed = partial(_crossed, data, ("measure", "regime"), measures, names)
    header = ["measure", *names]
    lines = crossed(lambda row: formatted(row["error"], "+.1%"))
    first = table("Largest error against the exact measure, on the same mesh", header, lines)
    title = "Processor time over that of the exact measure (problems that both solve; solved)"
    second = table(title, header, crossed(_ratio))
    return f"{first}\n\n{machine(second)}"


def _crossed(
    data: pd.DataFrame, keys: tuple[str, str], down: list[str], across: list[Any], shown: Callable[[pd.Series], str]
) -> list[list[str]]:
    """A line for each name ``down``: what is shown of its row for each value ``across``, a dash where it has none."""
    rows = {tuple(row[key] for key in keys): row for _, row in data.iterrows()}
    return [
        [code(name), *(shown(rows[name, value]) if (name, value) in rows else NOTHING for value in across)]
        for name in down
    ]


def _ratio(row: pd.Series) -> str:
    if pd.isna(row["seconds_ratio"]):
        return NOTHING
    return f"{fixed(row['seconds_ratio'], 2)} ({row['both']:.0f}; {share(row['solved_share'], 0)})"


def _contact(store: Store) -> Part:
    names = ("which-algorithm", "algorithm-sizes", "algorithm-failures", "trial-and-error-ends")
    more = "[More: costs of the algorithms](algorithms.md), [solved, failed, refused](outcomes.md)"
    parts = (summary_table(store), sizes_table(store))
    return _section("Which contact algorithm?", store, names, *parts, more=more)


def summary_table(store: Store) -> str:
    """What each algorithm solves and refuses, and its time over that of the default."""
    if not store.has_analysis("contact_summary"):
        return ""
    data = store.analysis("contact_summary")
    data = data.assign(put=data["solved"] + data["failed"])
    heads = "algorithm | solved | of | share | failed | refused | seconds over the default | both solve"
    line = "{algorithm:code} | {solved} | {put} | {solved_share:.1%} | {failed} | {refused} | "
    line += "{seconds_ratio:.2f} [{seconds_low:.2f}, {seconds_high:.2f}] | {both}"
    made = machine(listing("Contact algorithms: solved share, and time in the median", data, heads, line))
    why = data[(data["causes"] != "") | (data["refusals"] != "")].sort_values("algorithm")  # whatever the machine
    if why.empty:
        return made
    told = listing(
        "Why", why, "algorithm | failed | refused", "{algorithm:code} | {causes:said} | {refusals:said}", words=3
    )
    return f"{made}\n\n{folded('What fails and what is refused', told)}"


def sizes_table(store: Store) -> str:
    """Seconds of the default and the others over it, by the number of unknowns."""
    if not store.has_table("contact_sizes"):
        return ""
    data = store.table("contact_sizes")
    sizes = sorted(data["unknowns"].unique())
    lines = _crossed(data, ("algorithm", "unknowns"), list(dict.fromkeys(data["algorithm"])), sizes, _sized)
    title = "The tyre pressed to 20 mm: seconds, and over the default in brackets, by unknowns"
    return machine(table(title, ["algorithm", *(f"{size:.0f}" for size in sizes)], lines))


def _sized(row: pd.Series) -> str:
    return NOTHING if pd.isna(row["seconds"]) else f"{digits(row['seconds'], 2)} ({fixed(row[OVER], 2)})"


def _accuracy(store: Store) -> Part:
    names = ("price-tyre", "price-hemisphere", "price-roof-d", "one-per-cent", "grids-of-the-tyre")
    more = "[More: cost and accuracy](tradeoff.md), [cost of the tyre](cost.md), [advice](advice.md)"
    return _section("What does accuracy cost?", store, names, prices_table(store), more=more)


def prices_table(store: Store) -> str:
    """The cheapest way to an error on scenes that are well known."""
    if not store.has_analysis("price_of_accuracy"):
        return ""
    data = store.analysis("price_of_accuracy")
    data = data[data["tolerance"].isin(TOLD)]
    got = data["reached"].astype(bool)
    data = data.assign(got=["" if yes else " (nearest)" for yes in got])
    heads = "scene | within | configuration | error at most | seconds | unknowns"
    line = "{scene:code} | {tolerance:.1%} | {configuration}{got} | {bound:.2%} | {seconds:.2g} | {unknowns:.0f}"
    made = listing("The cheapest configuration for an error", data, heads, line, words=3)
    return machine(made, commands(data["command"]))


def _claims(store: Store) -> Part:
    more = "[More: who says that it has solved it](algorithms.md#who-says-that-it-has-solved-it)"
    return _section('Does "solved" mean solved?', store, ("false-solved", "false-by-contender", "cycles"), more=more)


def _paper(store: Store) -> Part:
    names = ("printed-table", "tyre-linear", "epsilon", "mirror")
    more = "[More: the tyre](tyre.md), [regularisation by ε](epsilon.md), [symmetry](symmetry.md)"
    return _section("Is the paper's table reproduced?", store, names, more=more)


def _trust(store: Store) -> Part:
    names = ("force-known", "convergence", "manufactured", "algorithms-agree", "symmetry", "random-cases", "advice")
    more = """More: [cost of the tyre](cost.md), [convergence](convergence.md), [manufactured
solutions](manufactured.md), [agreement](contact-agreement.md), [random cases](fuzz.md), [advice](advice.md)"""
    return _section("How sure is this?", store, names, more=prose(more))


SECTIONS: tuple[Callable[[Store], Part], ...] = (_strains, _contact, _accuracy, _claims, _paper, _trust)


def limitations(store: Store) -> Part:
    """What is known not to hold, as computed, and what is not covered at all."""
    found = [each for each in statements(store) if each.role == "limitation"]
    steady = [f"- {each.text}" for each in found if not each.machine]
    timed = [f"- {each.text}" for each in found if each.machine]
    about = sentence(store, "tyre-linear")
    steady += [f"- The paper's sentence on linear strains does not hold. {about}"] if about else []
    steady.append(
        "- These pages cover one shell element in static equilibrium. The obstacle is rigid, its friction Coulomb's "
        "with one coefficient; wear, rolling, dynamics and contact between two deformable bodies are not computed."
    )
    return joined("## Known limitations", "\n".join(steady), machine("\n".join(timed)) if timed else "")
