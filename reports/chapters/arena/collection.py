"""Part of the page of the arena: which frozen problems there are, what each family adds, and what was left out."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from reports.figures.drawing import canvas, look, svg
from reports.markdown import Part, commands, fold, joined, listing, picture, prose, table
from reports.store.tables import Store

HEADING = "## The collection"
COMMAND = "footprint problems make --out problems"
KINDS = ("definite", "indefinite", "not symmetric")


def collection_part(store: Store) -> Part:
    """The collection; its manifest comes with the suite, so every store has it."""
    kept, left_out = store.table("problems"), store.table("problems_left_out")
    text = prose("""Each problem is a step of Newton's method as an algorithm met it, in a file that needs nothing of
ours to be read; published obstacle problems and linear complementarity problems are beside them. A step is taken when
its combination of classes is new in its family: size, candidates, share pressed, kind of matrix, coupling, condition,
touching. *Touching* problems have candidates raised until they touch and carry nothing; *condensed* ones are the dual
in the nodal forces. Answers are not in the files.""")
    heads = ("family", "problems", "unknowns", "candidates", *KINDS, "consistent", "touching", "MB")
    rows = [_row(str(family), own) for family, own in kept.groupby("family", sort=False)]
    families = table("Families", heads, rows)
    warning = prose(f"""{_left_out(left_out)} The rule so favours those who solve as the first way does; who is compared
on the collection is compared on what somebody could certify.""")
    counted = reasons(left_out)
    rows_of_it = listing("Left out, why", counted, "family | why | steps", "{family} | {why} | {steps}", words=2)
    why = fold(f"{len(left_out)} steps by family and reason", rows_of_it)
    drawn = picture("arena-collection.svg", "Unknowns and candidates of every problem, by kind of matrix", draw(kept))
    return joined(HEADING, text, drawn, families, warning, why, commands([COMMAND]))


def _row(family: str, own: pd.DataFrame) -> tuple[object, ...]:
    kinds = [int((own["kind"] == kind).sum()) or "–" for kind in KINDS]
    consistent, touching = int((own["coupling"] == "consistent").sum()), int((own["touching"] > 0).sum())
    sizes = [_range(own[column]) for column in ("unknowns", "candidates")]
    return (family, len(own), *sizes, *kinds, consistent or "–", touching or "–", f"{own['bytes'].sum() / 1e6:.2f}")


def _range(values: pd.Series) -> str:
    low, high = int(values.min()), int(values.max())
    return f"{low:,}" if low == high else f"{low:,} to {high:,}"


def _left_out(rows: pd.DataFrame) -> str:
    if rows.empty:
        return "No step that the rule would have taken was left out for want of a certificate."
    large = int(rows["why"].str.contains("too many").sum())
    return (
        f"{len(rows)} steps were left out before the rule could ask whether they are new: {large} for the size of "
        f"their file, {len(rows) - large} because no way certifies an answer."
    )


def reasons(rows: pd.DataFrame) -> pd.DataFrame:
    """Reasons of each family, with how many steps have them: of the way that was tried first, numbers left out."""
    told = rows.assign(why=rows["why"].str.replace(r"[0-9][0-9.e+-]*", "…", regex=True).str.split(";").str[0])
    counted = told.groupby(["family", "why"], sort=False).size().rename("steps").reset_index()
    return counted.sort_values("steps", ascending=False, kind="stable")


@svg
def draw(kept: pd.DataFrame) -> Figure:
    """A dot a problem, in logarithmic axes."""
    figure, (axes,) = canvas(1, width=7.5, height=5.0)
    for i, kind in enumerate(KINDS):
        own = kept[kept["kind"] == kind]
        axes.plot(own["unknowns"], own["candidates"], **look(i).points, linestyle="", alpha=0.7, label=kind)
    axes.set(xscale="log", yscale="log", xlabel="unknowns", ylabel="candidates")
    axes.legend(title="matrix")
    return figure
