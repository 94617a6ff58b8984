"""The page of convergence: orders, extrapolated values, and errors split into those of mesh and model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from reports.chapter import Chapter
from reports.chapters.shells.element_choice import element_choice_part
from reports.chapters.shells.figures_convergence import Curve, mesh_errors
from reports.chapters.shells.solid_part import solid_part
from reports.ladders import Rung, families, read_ladders
from reports.markdown import NOTHING, Part, commands, fixed, folded, joined, percent, picture, prose, table
from reports.orders import FORMAL, SAFE, SAME_ORDER, SAME_VALUE, UNSAFE
from reports.tables import Store

INTRODUCTION = prose(f"""# Convergence

Every scene on three or more meshes with the default element, `element=refined`. An order is the p of an error c h^p,
fitted through three successive meshes; it needs no reference. A sequence is *asymptotic* when it is monotone and its
last two orders agree within {SAME_ORDER:g}; with three meshes there is one order only, and it must be within
{SAME_ORDER:g} of the {FORMAL:g} of a bilinear element. The extrapolated value is Richardson's with the last order, and
its uncertainty is the mesh error of the finest mesh times {SAFE:g}, outside the asymptotic range times {UNSAFE:g}. A
dash stands where there is no order.""")
WITHIN, BEYOND = "within the uncertainties", "beyond the uncertainties"


@dataclass(frozen=True)
class Split:
    """Relative difference of the finest mesh from one reference, and its two parts, all over the reference."""

    difference: float
    mesh: float | None
    model: float | None
    limit_uncertainty: float | None
    reference_uncertainty: float

    @property
    def verdict(self) -> str:
        """Is the model part more than what limit and reference may be off by?"""
        if self.model is None or self.limit_uncertainty is None:
            return "no limit"
        known = self.limit_uncertainty + self.reference_uncertainty
        return WITHIN if abs(self.model) <= known else BEYOND


def split(rung: Rung, reference: Mapping[str, Any]) -> Split:
    """The difference from a reference in parts: finest mesh less limit, limit less reference."""
    sequence, value = rung.sequence, float(reference["value"])
    finest, limit, uncertainty = sequence.values[-1], sequence.limit, sequence.uncertainty
    return Split(
        finest / value - 1,
        None if limit is None else (finest - limit) / value,
        None if limit is None else limit / value - 1,
        None if uncertainty is None else abs(uncertainty / value),
        float(reference["uncertainty"]),
    )


def convergence_page(store: Store) -> Part:
    """The whole page."""
    rungs = read_ladders(store)
    lines = commands(cell.command for rung in rungs for cell in rung.cells)
    measured = (_orders(rungs), _pictures(rungs), _parts(rungs), Part(lines))
    return joined([Part(INTRODUCTION), *measured, solid_part(store), element_choice_part(store)])


def _orders(rungs: list[Rung]) -> Part:
    """Values and orders of all sequences."""
    longest = max(len(rung.meshes) for rung in rungs)
    rows = []
    for rung in rungs:
        s = rung.sequence
        lead = [NOTHING] * (longest - len(s.values))
        values = [*lead, *(f"{value:.6g}" if value == value else NOTHING for value in s.values)]
        orders = [*lead, *(fixed(order, 2) for order in s.orders)]
        limit = NOTHING if s.limit is None else f"{s.limit:.6g}"
        off = NOTHING if s.limit is None or s.uncertainty is None else percent(abs(s.uncertainty / s.limit), 3, False)
        rows.append([rung.ladder, f"`{rung.quantity}`", _span(rung), *values, *orders, s.verdict, limit, off])
    good = [rung for rung in rungs if rung.sequence.asymptotic]
    same = sum(rung.sequence.verdict == "same on every mesh" for rung in rungs)
    text = prose(f"""## Orders and limits

{len(good)} of {len(rungs)} sequences are asymptotic, {same} of them because the mesh does not matter: their values
agree within {percent(SAME_VALUE, 3, False)}. *Last order*: of the three finest meshes; *order 1 before*: of the three
meshes one step coarser.

What can keep a sequence from its asymptotic range: two errors of different order and sign that take turns; a contact
patch that grows by whole nodes; and a point load. Under a point load a shell with transverse shear sinks in by a
logarithm of the element size, so a displacement there has no limit, and its orders fall for ever.""")
    names = ["finest", *(f"{i} coarser" for i in range(1, longest))][::-1]
    orders = ["last order", *(f"order {i} before" for i in range(1, longest - 2))][::-1]
    header = ["scene", "quantity", "meshes", *names, *orders, "asymptotic range", "extrapolated", "±"]
    return Part("\n\n".join([text, table("Quantities on all meshes, orders and limits", header, rows, words=3)]))


def _span(rung: Rung) -> str:
    return ", ".join(rung.meshes)


def _pictures(rungs: list[Rung]) -> Part:
    """One picture a family; a sequence without a limit, or without an error, has no line."""
    texts, drawn = [], {}
    for family, members in families(rungs):
        curves = []
        for rung in members:
            s = rung.sequence
            if s.limit is not None and not s.same:
                errors = tuple(value / s.limit - 1 for value in s.values)
                order = fixed(s.orders[-1], 2)
                curves.append(Curve(rung.ladder, rung.quantity, order, s.sizes, errors, s.asymptotic))
        if curves:
            name = f"convergence-{family.replace(' ', '-')}.svg"
            drawn[name] = mesh_errors(curves)
            texts.append(
                f"### {family.capitalize()}\n\n" + picture(name, f"Mesh errors over the element size, {family}")
            )
    text = prose("""## Mesh errors

Distance from the extrapolated value over the element size; the number behind a name is the last order. Full markers:
asymptotic.""")
    return Part("\n\n".join([text, *texts]), drawn)


def _parts(rungs: list[Rung]) -> Part:
    """Errors against the references, split."""
    pairs = [(rung, reference, split(rung, reference)) for rung in rungs for reference in rung.references]
    rows = [
        [
            rung.ladder,
            f"`{rung.quantity}`",
            str(reference["kind"]),
            f"{reference['value']:.6g}",
            *(percent(x, 3) for x in (s.difference, s.mesh, s.model)),
            *(percent(x, 3, False) for x in (s.limit_uncertainty, s.reference_uncertainty)),
            s.verdict,
        ]
        for rung, reference, s in pairs
    ]
    beyond = [
        f"- {rung.ladder}, `{rung.quantity}`, {reference['kind']}: {percent(s.model, 2)}"
        for rung, reference, s in pairs
        if s.verdict == BEYOND
    ]
    without = [f"{rung.ladder} `{rung.quantity}`" for rung in rungs if not rung.references]
    text = prose(f"""## Mesh part and model part

The difference of the finest mesh from a reference is the sum of two parts: the *mesh* part, the value on that mesh less
the extrapolated one, vanishes with the elements; the *model* part, the extrapolated value less the reference, does
not, and tells the shell, its section or the reference itself. A model part counts only where it is larger than the
uncertainties of limit and reference together; that is so in {len(beyond)} of {len(pairs)} comparisons. Kinds:
*exact* is a closed form, *computed* another program or a solid, *read* a public transcription of published values,
*printed* the source itself.""")
    header = ["scene", "quantity", "reference", "value", "finest - reference", "mesh part", "model part"]
    header += ["± limit", "± reference", "model part is"]
    blocks = [text, table("Errors split, relative to the reference", header, rows, words=3)]
    if beyond:
        blocks.append("Model parts beyond the uncertainties:\n\n" + "\n".join(beyond))
    if without:
        blocks.append(f"Without any reference: {', '.join(without)}.")
    sources = dict.fromkeys(f"- {rung.ladder}, {ref['kind']}: {ref['source']}" for rung, ref, _ in pairs)
    blocks.append(folded("Sources of the references", "\n".join(sources)))
    return Part("\n\n".join(blocks))


CHAPTER = Chapter(
    "convergence",
    "Convergence",
    "every scene on three meshes or more: order, limit, and the error split into mesh and model.",
    convergence_page,
    needs=("ladders",),
    always=True,
)
