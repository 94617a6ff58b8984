"""The page of convergence: orders, extrapolated values, and errors split into those of mesh and model."""

from __future__ import annotations

import numpy as np
import pandas as pd

from reports.chapter import Chapter
from reports.chapters.shells.element_choice import element_choice_part
from reports.chapters.shells.figures_convergence import mesh_changes
from reports.chapters.shells.solid_part import solid_part
from reports.chapters.shells.thickness_share import thickness_share_part
from reports.formats import code, fixed, number, quantity, share
from reports.markdown import Part, commands, filled, folded, joined, listing, picture, prose, table
from reports.store.tables import Store

DEFAULT = "refined"  # the element of the page


def convergence_page(store: Store) -> Part:
    """The whole page."""
    data = sequences(store)
    measured = _orders(store, data), _pictures(data), _parts(store, data), commands(data["command"])
    elements = element_choice_part(store), thickness_share_part(store)
    return joined(_introduction(store), _summary(store), *measured, solid_part(store), *elements)


def sequences(store: Store) -> pd.DataFrame:
    """The ladders of the default element, a row a mesh."""
    data = store.analysis("convergence")
    return data[(data["element"] == DEFAULT) & (data["ladder"] != "")]


def comparisons(store: Store, data: pd.DataFrame) -> pd.DataFrame:
    """One row a sequence and reference that holds for it: errors of the finest mesh, and what they are made of."""
    errors = store.analysis("convergence_errors")
    named = data.drop_duplicates("sequence")[["sequence", "ladder", "quantity", "asymptotic"]]
    return named.merge(errors.drop_duplicates(["sequence", "reference"], keep="last"), on="sequence")


def _introduction(store: Store) -> str:
    rule = store.rules()
    return prose(f"""# Convergence

Every scene on three or more meshes with the default element, `element=refined`. An order is the p of an error c h^p,
fitted through three successive meshes; it needs no reference. A sequence is *asymptotic* when it is monotone and its
last two orders agree within {rule["same_order"]:g}; with three meshes there is one order only, and it must be within
{rule["same_order"]:g} of the {rule["formal_order"]:g} of a bilinear element. Every mesh is nested in the next, which
halves its elements. The extrapolated value is Richardson's with the last order, and its uncertainty is the mesh error
of the finest mesh times {rule["safe"]:g}, outside the asymptotic range times {rule["unsafe"]:g}. A dash stands where
there is no order.""")


def _summary(store: Store) -> Part:
    """A line a family."""
    found = store.analysis("convergence_summary")
    whole = {str(key): value for key, value in found[found["family"] == "all"].iloc[0].items()}
    heads = "family | largest ± in | scenes | quantities | asymptotic | median ± | largest ± | comparisons | beyond"
    line = "{family} | {largest_in} | {scenes} | {sequences} | {asymptotic} | {median_uncertainty:.3%} | "
    line += "{largest_uncertainty:.2%} | {comparisons} | {beyond}"
    text = prose(f"""## In short

{whole["asymptotic"]} of {whole["sequences"]} quantities of {whole["scenes"]} scenes are in their asymptotic range;
{whole["limits"]} have a limit, known to {share(whole["median_uncertainty"], 3)} in the median and to
{share(whole["largest_uncertainty"])} at worst ({whole["largest_in"]}). In {whole["comparisons"] - whole["beyond"]} of
{whole["comparisons"]} comparisons with a reference the limit agrees with it within the uncertainties of both;
*beyond* are the others.""")
    return joined(text, listing("Limits and comparisons by family, default element", found, heads, line, words=2))


def _orders(store: Store, data: pd.DataFrame) -> Part:
    """Limits of all sequences, and all their values in a fold."""
    rows, values = [], []
    for _, own in data.groupby("sequence", sort=False):
        first, last = own.iloc[0], own.iloc[-1]
        named = [first["ladder"], quantity(first["quantity"])]
        off = share(abs(first["uncertainty"] / first["limit"]), 3)
        found = [last["mesh"], number(last["value"]), fixed(last["order"], 2), number(first["limit"]), off]
        rows.append([*named, first["verdict"], *found])
        each = ", ".join(f"{mesh}: {number(value)}" for mesh, value in zip(own["mesh"], own["value"], strict=True))
        orders = ", ".join(fixed(order, 2) for order in own["order"].iloc[2:])
        values.append([*named, code(first["quantity"]), each, orders])
    each_once = data.drop_duplicates("sequence")
    same = int(each_once["verdict"].str.startswith("same").sum())
    text = prose(f"""## Orders and limits

{int(each_once["asymptotic"].sum())} of {len(each_once)} sequences are asymptotic, {same} of them because the mesh does
not matter: their values agree within {share(store.rules()["same_value"], 3)}. *Last order*: of the three finest
meshes.

Lines are laid so that nothing else changes from mesh to mesh than the size of the elements: closer towards free edges,
where a shell with shear has a layer as wide as the wall is thick, and with one on the rim of contact where a closed
form knows it. Under a point load F a shell of the shear stiffness S sinks in by F/(2 π S) times the logarithm of the
element size, without a limit: displacements *of large elements* are those of elements as large as the wall is
thick.""")
    header = ["scene", "quantity", "asymptotic range", "finest mesh", "value there", "last order", "extrapolated", "±"]
    limits = table("Limits, default element", header, rows, words=3)
    header = ["scene", "quantity", "name", "values, coarse to fine", "orders, coarse to fine"]
    raw = table("Values on all meshes, default element", header, values, words=5)
    return joined(text, limits, _outside(data), folded("Values on all meshes", raw))


def _outside(data: pd.DataFrame) -> str:
    """A sentence for each sequence that is not asymptotic."""
    lines = []
    for _, own in data[~data["asymptotic"].astype(bool)].groupby("sequence", sort=False):
        first, values = own.iloc[0], own["value"].to_numpy(float)
        apart = share(np.ptp(values[-3:]) / abs(values[-1]), 2)
        orders = " and ".join(fixed(order, 2) for order in own["order"].iloc[2:])
        cause = first["cause"] or "the cause is not known"
        lines.append(
            f"- {first['ladder']}, {quantity(first['quantity'])}: {cause} (orders {orders}; the last three "
            f"meshes are {apart} apart)."
        )
    return "\n".join(["Not asymptotic, and why:", "", *lines]) if lines else ""


def _pictures(data: pd.DataFrame) -> Part:
    """One picture a family; a sequence whose values are the same on every mesh has no line."""
    curves = data[~data["verdict"].str.startswith("same")]
    still = data[data["verdict"].str.startswith("same")].drop_duplicates("sequence")
    parts: list[Part | str] = []
    for family in dict.fromkeys(data["family"]):
        own = curves[curves["family"] == family]
        if len(own):
            name, words = f"convergence-{family.replace(' ', '-')}.svg", f"Changes from mesh to mesh, {family}"
            parts += [f"### {family.capitalize()}", picture(name, words, mesh_changes(own))]
    text = prose(f"""## From mesh to mesh

By how much a value changes from a mesh to the next finer one, over the unknowns of the coarser one: no limit is needed
for that, and nothing lies on a line by construction. The number behind a name is the last order; full markers: in the
asymptotic range. Not drawn, because the mesh does not matter: {len(still)} quantities.""")
    return joined(text, *parts)


SPLIT = "scene | quantity | reference | model part is | value | mesh part | model part | ± limit | ± reference"
SPLIT_LINE = "{ladder} | {quantity:quantity} | {kind} | {verdict} | {value:g} | {mesh_part:+.3%} | {model_part:+.3%} | "
SPLIT_LINE += "{limit_uncertainty:.3%} | {uncertainty:.3%}"


def _parts(store: Store, data: pd.DataFrame) -> Part:
    """Errors against the references, split."""
    found = comparisons(store, data)
    beyond = filled(
        "- {ladder}, {quantity:quantity}, {kind}: {model_part:+.2%}", found[found["verdict"].str.startswith("beyond")]
    )
    missing = data[~data["sequence"].isin(found["sequence"])].drop_duplicates("sequence")
    without = ", ".join(filled("{ladder} {quantity:quantity}", missing))
    text = prose(f"""## Mesh part and model part

The difference of the finest mesh from a reference is the sum of two parts: the *mesh* part, the value on that mesh less
the extrapolated one, vanishes with the elements; the *model* part, the extrapolated value less the reference, does
not: it is that of the shell, its section or the reference itself. A model part counts only where it is larger than the
uncertainties of limit and reference together; that is so in {len(beyond)} of {len(found)} comparisons. Kinds:
*exact* is a closed form, *computed* another program or a solid, *read* a public transcription of published values,
*printed* the source itself.""")
    sources = dict.fromkeys(filled("- {ladder}, {kind}: {source}", found))
    return joined(
        text,
        listing("Errors split, relative to the reference", found, SPLIT, SPLIT_LINE, words=4),
        "\n".join(["Model parts beyond the uncertainties:", "", *beyond]) if beyond else "",
        f"Without any reference: {without}." if without else "",
        folded("Sources of the references", "\n".join(sources)),
    )


CHAPTER = Chapter(
    "convergence",
    "Convergence",
    "every scene on three meshes or more: order, limit, and the error split into mesh and model.",
    convergence_page,
    needs=(
        *("rules", "convergence", "convergence_errors", "convergence_summary", "element_choice", "thickness_share"),
        "solid_shell",
    ),
    always=True,
)
