"""The page of verification: limits against references by family, orders, options of the element, locking, programs."""

from __future__ import annotations

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.overview.decision import options_part
from reports.chapters.shells.element_choice import elements_part
from reports.chapters.shells.locking import locking_part
from reports.chapters.shells.manufactured import manufactured_part
from reports.chapters.shells.newton_steps import newton_sentence
from reports.formats import NOTHING, fixed, number, percent, quantity, share
from reports.markdown import Part, commands, filled, folded, joined, listing, prose, table
from reports.store.tables import Store

TITLE = "Verification: benchmarks, orders, locking"
DEFAULT = "refined"  # the element of the page
KINDS = ("exact", "computed", "printed", "read")  # of references; the first there is stands in the table
EQUILIBRIUM = 1e-8  # relative residual that passes without a look at rounding


def convergence_page(store: Store) -> Part:
    """The whole page."""
    data = sequences(store)
    parts = manufactured_part(store), elements_part(store), options_part(store), locking_part(store)
    return joined(f"# {TITLE}", _summary(store), _families(store, data), *parts, certificates(store))


def sequences(store: Store) -> pd.DataFrame:
    """The ladders of the default element, a row a mesh."""
    data = store.analysis("convergence")
    return data[(data["element"] == DEFAULT) & (data["ladder"] != "")]


def comparisons(store: Store, data: pd.DataFrame) -> pd.DataFrame:
    """One row a sequence and reference that holds for it: errors of the finest mesh, and what they are made of."""
    errors = store.analysis("convergence_errors")
    named = data.drop_duplicates("sequence")[["sequence", "ladder", "quantity", "asymptotic"]]
    return named.merge(errors.drop_duplicates(["sequence", "reference"], keep="last"), on="sequence")


def _summary(store: Store) -> Part:
    """A line a kind of strain and a family."""
    rule, found = store.rules(), store.analysis("convergence_summary")
    heads = "scenes of | number | quantities | asymptotic | median ± | comparisons | agree | median off"
    heads += " | largest off | in"
    line = "{group} | {scenes} | {sequences} | {asymptotic} | {median_uncertainty:.3%} | {comparisons} | {agree} | "
    line += "{median_off:.3%} | {largest_off:.2%} | {largest_off_in:said}"
    text = prose(f"""Every scene is solved with the default element (`element=refined`) on three meshes or more, each
nested in the next. The limit is Richardson's with the last order; ± is its uncertainty: {rule["safe"]:g} times the mesh
error of the finest mesh in the asymptotic range, where the last two orders agree within {rule["same_order"]:g},
{rule["unsafe"]:g} times outside. A limit *agrees* with a reference when they differ by no more than
both are uncertain by; *off* is that difference. References are closed forms, published values and other programs;
limits of our own grids do not count.""")
    return joined(text, listing("Limits against references", found, heads, line))


def _families(store: Store, data: pd.DataFrame) -> Part:
    """A table a family of scenes, and what does not agree."""
    found = comparisons(store, data)
    other = found[found["kind"].isin(KINDS)]
    ranked = other.assign(rank=other["kind"].map(KINDS.index)).sort_values(["rank", "uncertainty"], kind="stable")
    by = {row["sequence"]: row for row in ranked.drop_duplicates("sequence").to_dict("records")}
    header = ["scene", "quantity", "finest mesh", "value", "order", "limit", "±", "reference", "kind", "limit off"]
    parts: list[Part | str] = []
    for family, own in data.groupby("family", sort=False):
        rows = []
        for sequence, meshes in own.groupby("sequence", sort=False):
            last, reference = meshes.iloc[-1], by.get(sequence)
            known = [NOTHING, NOTHING, NOTHING]
            if reference is not None:
                sure = f"{reference['value']:g} ± {share(reference['uncertainty'])}"
                known = [sure, reference["kind"], percent(reference["model_part"])]
            named = [last["ladder"], quantity(last["quantity"]), last["mesh"], number(last["value"])]
            order = fixed(last["order"], 2) if last["asymptotic"] else f"({fixed(last['order'], 2)})"
            limit = [order, number(last["limit"]), share(abs(last["uncertainty"] / last["limit"]), 3)]
            rows.append([*named, *limit, *known])
        parts.append(table(f"{str(family).capitalize()}", header, rows, words=2))
    text = prose(f"""## Limits by family of scenes

An order in brackets is not asymptotic; a dash stands where there is none, because the mesh does not matter or the
values are not monotone. The reference shown is the most certain of the first of these kinds that there is:
{", ".join(KINDS)}. Displacements *of large elements* belong to
elements as large as the wall is thick: under a point load a shell with shear sinks in without a limit. Values on all
meshes and all references are in `convergence.csv` and `convergence_errors.csv`.""")
    beyond = other[other["verdict"].str.startswith("beyond")]
    line = "- {ladder}, {quantity:quantity}, {kind}: {model_part:+.2%} (reference known to {uncertainty:.2%})"
    lines = filled(line, beyond)
    said = f"{len(beyond)} of {int(other['model_part'].notna().sum())} limits differ by more than the uncertainties:"
    return joined(
        text,
        *parts,
        folded(said[:-1], "\n".join(lines)) if lines else "",
        _outside(data),
        commands(data.drop_duplicates("family", keep="last")["command"]),
    )


def _outside(data: pd.DataFrame) -> str:
    """Why sequences are not asymptotic, by cause."""
    own = data[~data["asymptotic"].astype(bool)].drop_duplicates("sequence")
    if own.empty:
        return ""
    causes = own.assign(cause=own["cause"].where(own["cause"] != "", "the cause is not known"))
    lines = []
    for cause, each in causes.groupby("cause", sort=False):
        names = (f"{ladder} ({quantity(name)})" for ladder, name in each[["ladder", "quantity"]].to_numpy())
        lines.append(f"- {', '.join(names)}: {cause}.")
    return folded(f"{len(own)} of {data['sequence'].nunique()} sequences are not asymptotic, and why", "\n".join(lines))


def certificates(store: Store) -> str:
    """How many reported states, of this page and all others, the judge certifies; and Newton's steps."""
    cells = store.cells
    steps = [step for cell in cells for step in cell.steps]
    failed = [step for step in steps if step["failures"]]
    rounded = sum(step["kkt"]["equilibrium"] > EQUILIBRIUM for step in steps)
    text = prose(f"""## Certificates

The judge recomputes equilibrium, the contact conditions and, where it can, the balances of energy and of all forces of
each of the {len(steps)} states on all pages; it certifies {len(steps) - len(failed)} of them. A residual above
{EQUILIBRIUM:g} that rounding explains is accepted only up to a bound; {rounded} states have one.
{newton_sentence(store)}""")
    if failed:
        names = dict.fromkeys(name for step in failed for name in step["failures"])
        scenes = dict.fromkeys(cell.scene for cell in cells if any(step["failures"] for step in cell.steps))
        text += f" Not certified, for {', '.join(names)}: states of {', '.join(scenes)}."
    return text


CHAPTER = Chapter(
    "convergence",
    TITLE,
    "every scene on three meshes or more against references, observed orders, which element, what locks.",
    convergence_page,
    needs=(
        *("rules", "convergence", "convergence_errors", "convergence_summary", "element_choice", "thickness_share"),
        *("manufactured", "manufactured_contact", "manufactured_statements"),
        *("thickness_locking", "shear_locking", "curved_beam", "membrane_locking"),
    ),
    always=True,
)
