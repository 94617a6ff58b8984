"""The page of convergence: orders, extrapolated values, and errors split into those of mesh and model."""

from __future__ import annotations

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.shells.element_choice import element_choice_part
from reports.chapters.shells.figures_convergence import mesh_errors
from reports.chapters.shells.solid_part import solid_part
from reports.markdown import NOTHING, Part, commands, fixed, folded, joined, number, percent, picture, prose, table
from reports.tables import Store

DEFAULT = "refined"  # the element of the page


def convergence_page(store: Store) -> Part:
    """The whole page."""
    data = sequences(store)
    measured = (_orders(store, data), _pictures(data), _parts(store, data), Part(commands(data["command"])))
    return joined([_introduction(store), *measured, solid_part(store), element_choice_part(store)])


def sequences(store: Store) -> pd.DataFrame:
    """The ladders of the default element, a row a mesh."""
    data = store.analysis("convergence")
    return data[(data["element"] == DEFAULT) & (data["ladder"] != "")]


def comparisons(store: Store, data: pd.DataFrame) -> pd.DataFrame:
    """One row a sequence and reference that holds for it: errors of the finest mesh, and what they are made of."""
    errors = store.analysis("convergence_errors")
    named = data.drop_duplicates("sequence")[["sequence", "ladder", "quantity", "asymptotic"]]
    return named.merge(errors.drop_duplicates(["sequence", "reference"], keep="last"), on="sequence")


def _introduction(store: Store) -> Part:
    rule = store.rules()
    text = prose(f"""# Convergence

Every scene on three or more meshes with the default element, `element=refined`. An order is the p of an error c h^p,
fitted through three successive meshes; it needs no reference. A sequence is *asymptotic* when it is monotone and its
last two orders agree within {rule["same_order"]:g}; with three meshes there is one order only, and it must be within
{rule["same_order"]:g} of the {rule["formal_order"]:g} of a bilinear element. The extrapolated value is Richardson's
with the last order, and its uncertainty is the mesh error of the finest mesh times {rule["safe"]:g}, outside the
asymptotic range times {rule["unsafe"]:g}. A dash stands where there is no order.""")
    return Part(text)


def _orders(store: Store, data: pd.DataFrame) -> Part:
    """Values and orders of all sequences."""
    longest = int(data.groupby("sequence").size().max())
    rows = []
    for _, own in data.groupby("sequence", sort=False):
        first, lead = own.iloc[0], [NOTHING] * (longest - len(own))
        values = [*lead, *(number(value) for value in own["value"])]
        orders = [*lead, *(fixed(order, 2) for order in own["order"].iloc[2:])]
        off = percent(abs(first["uncertainty"] / first["limit"]), 3, False)
        named = [first["ladder"], f"`{first['quantity']}`", ", ".join(own["mesh"])]
        rows.append([*named, *values, *orders, first["verdict"], number(first["limit"]), off])
    each = data.drop_duplicates("sequence")
    same = int(each["verdict"].str.startswith("same").sum())
    text = prose(f"""## Orders and limits

{int(each["asymptotic"].sum())} of {len(each)} sequences are asymptotic, {same} of them because the mesh does not
matter: their values agree within {percent(store.rules()["same_value"], 3, False)}. *Last order*: of the three finest
meshes; *order 1 before*: of the three meshes one step coarser.

What can keep a sequence from its asymptotic range: two errors of different order and sign that take turns; a contact
patch that grows by whole nodes; and a point load. Under a point load a shell with transverse shear sinks in by a
logarithm of the element size, so a displacement there has no limit, and its orders fall for ever.""")
    names = ["finest", *(f"{i} coarser" for i in range(1, longest))][::-1]
    steps = ["last order", *(f"order {i} before" for i in range(1, longest - 2))][::-1]
    header = ["scene", "quantity", "meshes", *names, *steps, "asymptotic range", "extrapolated", "±"]
    return Part("\n\n".join([text, table("Quantities on all meshes, orders and limits", header, rows, words=3)]))


def _pictures(data: pd.DataFrame) -> Part:
    """One picture a family; a sequence without a limit, or without an error, has no line."""
    texts, drawn = [], {}
    curves = data[data["limit"].notna() & ~data["verdict"].str.startswith("same")]
    for family in dict.fromkeys(data["family"]):
        own = curves[curves["family"] == family]
        if len(own):
            name = f"convergence-{family.replace(' ', '-')}.svg"
            drawn[name] = mesh_errors(own)
            texts.append(
                f"### {family.capitalize()}\n\n" + picture(name, f"Mesh errors over the element size, {family}")
            )
    text = prose("""## Mesh errors

Distance from the extrapolated value over the element size; the number behind a name is the last order. Full markers:
asymptotic.""")
    return Part("\n\n".join([text, *texts]), drawn)


def _parts(store: Store, data: pd.DataFrame) -> Part:
    """Errors against the references, split."""
    found = comparisons(store, data)
    rows = [
        [
            row["ladder"],
            f"`{row['quantity']}`",
            row["kind"],
            number(row["value"]),
            *(percent(row[part], 3) for part in ("error", "mesh_part", "model_part")),
            *(percent(row[part], 3, False) for part in ("limit_uncertainty", "uncertainty")),
            row["verdict"],
        ]
        for row in found.to_dict("records")
    ]
    beyond = [
        f"- {row['ladder']}, `{row['quantity']}`, {row['kind']}: {percent(row['model_part'], 2)}"
        for row in found[found["verdict"].str.startswith("beyond")].to_dict("records")
    ]
    missing = data[~data["sequence"].isin(found["sequence"])].drop_duplicates("sequence")
    without = [f"{row['ladder']} `{row['quantity']}`" for row in missing.to_dict("records")]
    text = prose(f"""## Mesh part and model part

The difference of the finest mesh from a reference is the sum of two parts: the *mesh* part, the value on that mesh less
the extrapolated one, vanishes with the elements; the *model* part, the extrapolated value less the reference, does
not, and tells the shell, its section or the reference itself. A model part counts only where it is larger than the
uncertainties of limit and reference together; that is so in {len(beyond)} of {len(rows)} comparisons. Kinds:
*exact* is a closed form, *computed* another program or a solid, *read* a public transcription of published values,
*printed* the source itself.""")
    header = ["scene", "quantity", "reference", "value", "finest - reference", "mesh part", "model part"]
    header += ["± limit", "± reference", "model part is"]
    blocks = [text, table("Errors split, relative to the reference", header, rows, words=3)]
    if beyond:
        blocks.append("Model parts beyond the uncertainties:\n\n" + "\n".join(beyond))
    if without:
        blocks.append(f"Without any reference: {', '.join(without)}.")
    sources = dict.fromkeys(f"- {row['ladder']}, {row['kind']}: {row['source']}" for row in found.to_dict("records"))
    blocks.append(folded("Sources of the references", "\n".join(sources)))
    return Part("\n\n".join(blocks))


CHAPTER = Chapter(
    "convergence",
    "Convergence",
    "every scene on three meshes or more: order, limit, and the error split into mesh and model.",
    convergence_page,
    needs=("rules", "convergence", "convergence_errors", "element_choice", "solid_shell"),
    always=True,
)
