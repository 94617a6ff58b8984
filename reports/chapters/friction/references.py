"""Part of the page of algorithms with friction: closed forms, orders, and what must not change."""

from __future__ import annotations

import pandas as pd

from reports.formats import NOTHING, formatted
from reports.markdown import Part, joined, listing, machine, prose
from reports.store.tables import Store

FAMILIES = {
    "strip": "a bar dragged over a plane under uniform pressure, unloaded and cycled; *counted* is the length of the "
    "slip zone by counting nodes, *front* by the vertex of the parabola of slips",
    "drum": "a strip pulled over a drum, or pushed in a hollow one: partial slip",
    "capstan": "the same in gross slip: N1/N0 = exp(mu theta)",
    "parking": "a disc of springs turned on the spot until a core sticks: core, torque, loop of a cycle",
    "path": "a block on springs, its plane dragged along a quarter circle, against the ordinary differential equation",
}
LOST = 1e-8  # an error below this is not shown in digits


def references_part(store: Store) -> Part:
    """All of it; a table that is missing leaves its section out."""
    heading = prose("""## Closed forms and other references

All are solved by `semismooth`, on reference problems that an answer is written down for; the other algorithms are held
against it on the same problems by the tests.""")
    parts = {
        "friction_joint_motion": _together,
        "friction_rolling": _rolling,
        "friction_tied": _tied,
        "friction_crushed_ring": _crushed,
    }
    return joined(heading, _orders(store), *(part(store) for name, part in parts.items() if store.has_table(name)))


def _orders(store: Store) -> Part:
    """Errors on the finest meshes, and their orders."""
    data = store.analysis("friction_orders")
    known = [f"- *{name}*: {words}" for name, words in FAMILIES.items() if name in set(data["family"])]
    text = prose("""### Orders

Errors are relative, on the finest mesh or the finest steps; orders are fitted to the four finest. Meshes are chosen so
that the edge of a slip zone falls alike between two nodes, or an error has no order to speak of. A dash: the error is
too small to have one.""")
    heads = "reference | case | error of | finest | error | order | theory"
    line = "{family} | {case} | {quantity} | {finest:g} {of} | {error:lost} | {order:.2f} | {theory}"
    return joined(text, "\n".join(known), listing("Errors and orders", data, heads, line, words=3, lost=_lost))


def _lost(value: float) -> str:
    return f"< {LOST:.0e}" if abs(value) < LOST else formatted(value, "+.1e")


def _together(store: Store) -> Part:
    """Body and foundation moved together."""
    data = store.table("friction_joint_motion")
    text = prose("""### Moved together

A pyramid of bars stands on four feet; it and its plane are moved and turned together, far. Friction, as it is seen from
the plane, must stay what it is, and nothing may be dissipated. In the last step the plane moves *alone*, by thousandths
of a millimetre: the check would see it.""")
    shown = data.assign(turned=data["turn_rad"], way=data["way_mm"])
    heads = "load | step | turn [rad] | way [mm] | friction [N] | change of friction [N] | of normal forces [N]"
    heads += " | dissipated [N mm]"
    line = "{load} | {step} | {turned:.4g} | {way:.4g} | {friction_N:.3g} | {change_N:.0e} | {normal_change_N:.0e}"
    line += " | {dissipation_N_mm:.0e}"
    return joined(text, machine(listing("Friction while both move", shown, heads, line, words=2)))


def _rolling(store: Store) -> Part:
    """The wheel."""
    data = store.table("friction_rolling")
    text = prose("""### A rolling wheel

A wheel of bars is squeezed between two plates, and the upper one moves: by symmetry the hub comes by half of its way,
and where no node slips the wheel rolls on the radius of its bars as they lie. *Steps with slip* is how many of them
have a node that slips; only there is anything dissipated.""")
    heads = "μ | step [mm] | hub off its place [mm] | off the middle [mm] | steps with slip | dissipated [N mm]"
    heads += " | radius [mm] | off that of the bars"
    line = "{mu:g} | {step_mm:g} | {hub_error_mm:.0e} | {middle_error_mm:.0e} | {slips} | {dissipated_N_mm:.1e}"
    line += " | {radius_mm:.4f} | {radius_error:.0e}"
    return joined(text, machine(listing("The wheel", data, heads, line)))


def _tied(store: Store) -> Part:
    """An infinite coefficient."""
    data = store.table("friction_tied")
    named = data.assign(
        ties=_or_dash(data["tied"]), unlike=_or_dash(data["otherwise"]), off=data["difference"].astype(float)
    )
    text = prose("""### Tied where it touches

With μ = ∞ whoever touches is tied to its place. On coarse meshes of the GRECO plate every set of tied nodes can be
tried by elimination alone: there is one for which none is pulled and none penetrates, or none at all. Where there is
none the right end is not to converge.""")
    heads = "element | elements | load | nodes | answers | outcome | tied | otherwise | displacements off"
    line = "{element} | {elements} | {load} | {nodes} | {answers} | {outcome} | {ties} | {unlike} | {off:.0e}"
    return joined(text, machine(listing("μ = ∞, beside all answers", named, heads, line, words=3)))


def _crushed(store: Store) -> Part:
    """Friction on the crushed ring, beside another program's."""
    data = store.table("friction_crushed_ring")
    text = prose("""### The crushed ring

A ring of rubber between two plates (SSNP501 and SSNP502 of Code_Aster), with friction and without: what friction adds
to the force, beside what Code_Aster finds, which has another law of the material; so changes are compared, not
forces.""")
    shown = data.assign(refused=data["failures"].astype(object).where(data["failures"].notna(), ""))
    heads = "scene | approach [mm] | force without [N] | with friction [N] | change | of Code_Aster | refused for"
    line = "{scene:code} | {delta_mm:g} | {smooth_N:.3f} | {force_N:.3f} | {change:+.2%} | {aster_change:+.2%}"
    line += " | {refused:said}"
    return joined(text, listing(f"What μ = {data['mu'].iloc[0]:g} adds", shown, heads, line))


def _or_dash(values: pd.Series) -> list[str]:
    return [NOTHING if pd.isna(value) else f"{value:.0f}" for value in values]
