"""Contact of other bodies than shells with known answers: a membrane over a sphere, a plate on a plane."""

from __future__ import annotations

from reports.formats import NOTHING, scientific
from reports.markdown import Part, joined, listing, prose
from reports.store.tables import Store


def known_answers(store: Store) -> list[Part]:
    """A part for each table that the store has; older ones have none."""
    parts = {"membrane": _membrane, "greco_plate": _plate}
    return [part(store) for name, part in parts.items() if store.has_table(name)]


def _membrane(store: Store) -> Part:
    """A membrane over a sphere, whose contact radius is known."""
    data = store.table("membrane")
    finest = data[data["level"] == data.groupby(["element", "algorithm"])["level"].transform("max")]
    text = prose(f"""## Orders where the contact radius is known

A membrane over half a sphere (example 36 of MFEM): deflection, contact radius and force are closed forms. Linear
triangles (P1), bilinear and biquadratic quadrilaterals (Q1, Q2), the obstacle kept at the nodes. Orders are fitted to
all meshes of an algorithm: of u in the mean square (L2) and in the energy (H1), of the force, and of the radius of the
disc with the area of the nodes in contact. Theory: 2 and 1 for linear elements, 3/2 in the energy for quadratic ones
and no more, because the second derivative jumps on the rim. The last two jump themselves, as the rim passes between
nodes. On one mesh the deflections of all exact algorithms differ by at most
{scientific(float(data["apart"].max()))} of the largest one.""")
    heads = "element | unknowns | algorithm | iterations | error of the force | of the radius"
    heads += " | order, L2 | H1 | force | radius"
    line = "{element} | {unknowns} | {algorithm} | {iterations:.0f} | {force:.1e} | {radius:.1e}"
    line += " | {order_l2:.2f} | {order_h1:.2f} | {order_force:.2f} | {order_radius:.2f}"
    return joined(text, listing("A membrane over a sphere, finest meshes", finest, heads, line))


def _plate(store: Store) -> Part:
    """The GRECO plate without friction."""
    data = store.table("greco_plate")
    finest = data[data["elements"] == data["elements"].max()]
    shown = finest.drop_duplicates(["element", "load"])
    off = float(data["pressure_error"].max())
    text = prose(f"""## A plate on a plane

The GRECO plate before it has friction: an elastic square of 40 mm in plane strain, pressed on the plane by 50 MPa and
pushed by 150 MPa from the left. Under the *uniform* load its bottom must carry 50 MPa everywhere, on any mesh: all
{data["algorithm"].nunique()} exact algorithms miss that by at most {scientific(off)} of it. A load that *rises* to the
right leaves all of the bottom pressed; one that pulls on the left is *lifting* that corner off. Deflections of all
algorithms on one mesh differ by at most {scientific(float(data["apart"].max()))} of the largest one.""")
    heads = "element | elements | load | slip of the left corner [mm] | largest gap [mm] | pressed from x [mm]"
    heads += " | error of the pressure"
    line = "{element} | {elements} | {load} | {slip_mm:.6f} | {lift_mm:.6f} | {edge_mm:.3f} | {pressure_error:error}"

    def error(value: float) -> str:
        return NOTHING if value != value else scientific(value)

    return joined(text, listing("The plate on the finest meshes", shown, heads, line, words=3, error=error))
