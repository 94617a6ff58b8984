"""The page of convergence: orders, extrapolated values, and errors split into those of mesh and model."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reports.chapter import Chapter
from reports.chapters.shells.element_choice import element_choice_part
from reports.chapters.shells.solid_part import solid_part
from reports.chapters.shells.thickness_share import thickness_share_part
from reports.drawing import BLACK, LINES, MARKERS, canvas, look, svg, ticks
from reports.formats import NOTHING, code, fixed, number, share
from reports.markdown import Part, commands, filled, folded, joined, listing, picture, prose, table
from reports.store.tables import Store

DEFAULT = "refined"  # the element of the page


def convergence_page(store: Store) -> Part:
    """The whole page."""
    data = sequences(store)
    measured = _orders(store, data), _pictures(data), _parts(store, data), commands(data["command"])
    elements = element_choice_part(store), thickness_share_part(store)
    return joined(_introduction(store), *measured, solid_part(store), *elements)


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


def _orders(store: Store, data: pd.DataFrame) -> Part:
    """Values and orders of all sequences."""
    longest = int(data.groupby("sequence").size().max())
    rows = []
    for _, own in data.groupby("sequence", sort=False):
        first, lead = own.iloc[0], [NOTHING] * (longest - len(own))
        values = [*lead, *map(number, own["value"])]
        orders = [*lead, *(fixed(order, 2) for order in own["order"].iloc[2:])]
        named = [first["ladder"], code(first["quantity"]), ", ".join(own["mesh"])]
        off = share(abs(first["uncertainty"] / first["limit"]), 3)
        rows.append([*named, *values, *orders, first["verdict"], number(first["limit"]), off])
    each = data.drop_duplicates("sequence")
    same = int(each["verdict"].str.startswith("same").sum())
    text = prose(f"""## Orders and limits

{int(each["asymptotic"].sum())} of {len(each)} sequences are asymptotic, {same} of them because the mesh does not
matter: their values agree within {share(store.rules()["same_value"], 3)}. *Last order*: of the three finest
meshes; *order 1 before*: of the three meshes one step coarser.

Lines are laid so that nothing else changes from mesh to mesh than the size of the elements: closer towards free edges,
where a shell with shear has a layer as wide as the wall is thick, and with one on the rim of contact where a closed
form knows it. Under a point load F a shell of the shear stiffness S sinks in by F/(2 π S) times the logarithm of the
element size, without a limit: `even` displacements are those of elements as large as the wall is thick.""")
    names = ["finest", *(f"{i} coarser" for i in range(1, longest))][::-1]
    steps = ["last order", *(f"order {i} before" for i in range(1, longest - 2))][::-1]
    header = ["scene", "quantity", "meshes", *names, *steps, "asymptotic range", "extrapolated", "±"]
    return joined(text, table("Quantities on all meshes, orders and limits", header, rows, words=3), _outside(data))


def _outside(data: pd.DataFrame) -> str:
    """A sentence for each sequence that is not asymptotic."""
    lines = []
    for _, own in data[~data["asymptotic"].astype(bool)].groupby("sequence", sort=False):
        first, values = own.iloc[0], own["value"].to_numpy(float)
        apart = share(np.ptp(values[-3:]) / abs(values[-1]), 2)
        orders = " and ".join(fixed(order, 2) for order in own["order"].iloc[2:])
        cause = "the cause is not known" if pd.isna(first["cause"]) else first["cause"]
        lines.append(
            f"- {first['ladder']}, {code(first['quantity'])}: {cause} (orders {orders}; the last three "
            f"meshes are {apart} apart)."
        )
    return "\n".join(["Not asymptotic, and why:", "", *lines]) if lines else ""


def _pictures(data: pd.DataFrame) -> Part:
    """One picture a family; a sequence without a limit, or without an error, has no line."""
    curves = data[data["limit"].notna() & ~data["verdict"].str.startswith("same")]
    families = {family: curves[curves["family"] == family] for family in dict.fromkeys(data["family"])}
    parts: list[Part | str] = []
    for family, own in families.items():
        if len(own):
            name, words = f"convergence-{family.replace(' ', '-')}.svg", f"Mesh errors over the element size, {family}"
            parts += [f"### {family.capitalize()}", picture(name, words, mesh_errors(own))]
    text = prose("""## Mesh errors

Distance from the extrapolated value over the element size; the number behind a name is the last order. Full markers:
asymptotic.""")
    return joined(text, *parts)


@svg
def mesh_errors(data: pd.DataFrame) -> Figure:
    """Errors over the element size, as a share of that of the coarsest mesh, log-log: a row a mesh of sequences.

    A colour is a scene, a line and a marker one of its quantities, a full marker a sequence in its asymptotic range.
    Dotted black: first and second order.
    """
    drawn = dict.fromkeys(data["ladder"], 0)
    scenes = list(drawn)
    finest, top = 1.0, 0.0
    figure, (axes,) = canvas(width=8.5, height=4.2)
    for _, own in data.groupby("sequence", sort=False):
        first, errors = own.iloc[0], np.abs(own["value"].to_numpy(float) / own["limit"].to_numpy(float) - 1)
        scene, j = first["ladder"], drawn[first["ladder"]]
        drawn[scene] += 1
        line = {"color": look(scenes.index(scene)).colour, "linestyle": LINES[j % len(LINES)]}
        marker = {"marker": MARKERS[j % len(MARKERS)], "fillstyle": "full" if first["asymptotic"] else "none"}
        h = own["size"].to_numpy(float) / first["size"]
        name = f"{scene}, {first['quantity']}: {fixed(own['order'].iloc[-1], 2)}"
        axes.loglog(h, errors, **line, **marker, label=name)
        finest, top = min(finest, float(h[-1])), max(top, 2 * float(errors[0]))
    for order in (1, 2):
        axes.loglog([finest, 1], [top * finest**order, top], color=BLACK, linestyle=":", linewidth=1)
        axes.text(0.97 * finest, top * finest**order, f"order {order}", ha="right", va="center", fontsize=8)
    places = [1 / k for k in (1, 2, 3, 4, 6, 8) if 1 / k > 0.99 * finest]
    ticks(axes, places, [f"1/{1 / place:.0f}" if place < 1 else "1" for place in places])
    axes.set(xlabel="element size over that of the coarsest mesh", ylabel="relative mesh error")
    axes.set_xlim(0.65 * finest, 1.15)
    figure.legend(loc="outside right upper", fontsize=8)
    return figure


SPLIT = "scene | quantity | reference | value | finest - reference | mesh part | model part"
SPLIT_LINE = "{ladder} | `{quantity}` | {kind} | {value:g} | {error:+.3%} | {mesh_part:+.3%} | {model_part:+.3%}"


def _parts(store: Store, data: pd.DataFrame) -> Part:
    """Errors against the references, split."""
    found = comparisons(store, data)
    beyond = filled(
        "- {ladder}, `{quantity}`, {kind}: {model_part:+.2%}", found[found["verdict"].str.startswith("beyond")]
    )
    missing = data[~data["sequence"].isin(found["sequence"])].drop_duplicates("sequence")
    without = ", ".join(filled("{ladder} `{quantity}`", missing))
    heads = f"{SPLIT} | ± limit | ± reference | model part is"
    line = SPLIT_LINE + " | {limit_uncertainty:.3%} | {uncertainty:.3%} | {verdict}"
    text = prose(f"""## Mesh part and model part

The difference of the finest mesh from a reference is the sum of two parts: the *mesh* part, the value on that mesh less
the extrapolated one, vanishes with the elements; the *model* part, the extrapolated value less the reference, does
not, and tells the shell, its section or the reference itself. A model part counts only where it is larger than the
uncertainties of limit and reference together; that is so in {len(beyond)} of {len(found)} comparisons. Kinds:
*exact* is a closed form, *computed* another program or a solid, *read* a public transcription of published values,
*printed* the source itself.""")
    sources = dict.fromkeys(filled("- {ladder}, {kind}: {source}", found))
    return joined(
        text,
        listing("Errors split, relative to the reference", found, heads, line, words=3),
        "\n".join(["Model parts beyond the uncertainties:", "", *beyond]) if beyond else "",
        f"Without any reference: {without}." if without else "",
        folded("Sources of the references", "\n".join(sources)),
    )


CHAPTER = Chapter(
    "convergence",
    "Convergence",
    "every scene on three meshes or more: order, limit, and the error split into mesh and model.",
    convergence_page,
    needs=("rules", "convergence", "convergence_errors", "element_choice", "thickness_share", "solid_shell"),
    always=True,
)
