"""The page of friction: the tyre dragged and turned, its patch, load steps, and the parts of the algorithms."""

from __future__ import annotations

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.friction.algorithms import SOLVED, algorithms_part, checks_part
from reports.chapters.friction.figures import dragged, path_errors, turned
from reports.chapters.friction.filmstrip import filmstrip
from reports.formats import formatted, percent, share
from reports.markdown import Part, commands, joined, listing, picture, prose
from reports.store.tables import Store

TYRE = ("friction_dragged", "friction_turned", "friction_patch", "friction_steps")
FITTED = ("friction_drag_ends", "friction_turn_ends", "friction_step_orders", "friction_algorithms", "friction_orders")
OTHERS = ("friction_agreement", "friction_greco", "friction_klarbring")


def friction_page(store: Store) -> Part:
    """The whole page."""
    sections = (_moved, _patch, _path, algorithms_part, checks_part)
    return joined(_introduction(store), *(section(store) for section in sections))


def _introduction(store: Store) -> str:
    ends = store.analysis("friction_drag_ends")
    return prose(f"""# {CHAPTER.title}

The paper's tyre, the whole of it on {ends["mesh"].iloc[0]} elements, is inflated and pressed on a rigid plane with
Coulomb friction; then the plane is dragged across the rolling direction, or turned about its normal through the centre
of the patch. A node in contact with the normal force f *sticks* to its place on the plane, with a friction force of at
most μ f, or *slips* and carries μ f against its way since the load step began. F_n is the sum of f, F_t the resultant
along the plane, r the distance of a node from the axis of the turn. Rolling, heat, and a coefficient that depends on
speed or pressure are not covered.""")


def _moved(store: Store) -> Part:
    """Force over the way of the plane, torque over its angle, and what the dissipation along them is worth."""
    drag, turn = store.analysis("friction_drag_ends"), store.analysis("friction_turn_ends")
    full = share(store.rules()["friction_full"], 0)
    text = prose(f"""## Dragged, and turned on the spot

Once every node in contact slips, the force is μ F_n on any mesh. The torque is that of parking, μ Σ f r, times
cos(step/2): the slip of a step is the chord of its arc. *Full from*: the first stop from which the value stays within
{full} of that bound; *all slip from*: the first stop from which no node sticks, but for the one in the centre of a
turn.""")
    heads = "μ | F_n pressed [N] | F_n at the end [N] | largest F_t [N] | at [mm] | full from [mm] | all slip from [mm]"
    heads += " | F_t at the end [N] | off μ F_n | dissipated [N m]"
    line = "{mu:g} | {pressed_N:.1f} | {force_N:.1f} | {largest:.2f} | {at:g} | {full:g} | {loose:g}"
    line += " | {value:.2f} | {off:small} | {work:.2f}"
    around = "μ | largest torque [N m] | at [deg] | full from [deg] | all slip from [deg] | torque at the end [N m]"
    around += " | μ Σ f r [N m] | off that times cos(step/2) | dissipated [N m]"
    turning = "{mu:g} | {peak:.3f} | {at:g} | {full:g} | {loose:g} | {torque:.3f} | {limit:.3f} | {off:small}"
    turning += " | {work:.2f}"
    far = f"Dragged by {drag['last'].iloc[0]:g} mm"
    named = turn.assign(peak=turn["largest"] / 1e3, torque=turn["value"] / 1e3, limit=turn["bound"] / 1e3)
    pulled = listing(far, _with_work(drag, store.table(TYRE[0])), heads, line, small=_small)
    spun = listing(
        f"Turned by {turn['last'].iloc[0]:g} degrees",
        _with_work(named, store.table(TYRE[1])),
        around,
        turning,
        small=_small,
    )
    return joined(
        text,
        picture(
            "friction-dragged.svg",
            "Friction over the way of the plane in N and over the normal force, for several coefficients",
            dragged(store.table(TYRE[0])),
        ),
        pulled,
        picture(
            "friction-turned.svg",
            "Parking torque over the angle, in N m and over its bound, for several coefficients",
            turned(store.table(TYRE[1])),
        ),
        spun,
        _warning(store),
        _refused(store),
        commands([*drag["command"], *turn["command"]]),
    )


def _with_work(ends: pd.DataFrame, moved: pd.DataFrame) -> pd.DataFrame:
    """The ends of paths with what is dissipated on them, the press included."""
    return ends.assign(work=ends["mu"].map(moved.groupby("mu")["dissipation_N_mm"].last() / 1e3))


def _warning(store: Store) -> str:
    coarse = store.table("friction_steps").sort_values("steps").iloc[0]
    many = "one step" if coarse["steps"] == 1 else f"{coarse['steps']:g} steps"
    work, force = percent(coarse["dissipation_N_mm_error"], 0), percent(coarse["friction_N_error"], 1)
    return prose(f"""**Do not rely on the dissipation of these tables.** It converges with the load step, in first
order, and the paths above have one step from stop to stop: pressed and dragged by 1 mm in {many} each the dissipation
has an error of {work}, the force one of {force} ([load steps](#load-steps)).""")


def _refused(store: Store) -> str:
    """Loads of the drags and turns that are not certified, or where the path has ended."""
    moved = pd.concat([store.table(name) for name in TYRE[:2]])
    odd = moved[moved["failures"].notna() | (moved["outcome"] != SOLVED[0])]
    if odd.empty:
        return f"All {len(moved)} loads of these paths converged and are certified by the judge."
    heads, line = "μ | drag [mm] | turn [deg] | outcome | failed", "{mu:g} | {drag_mm:g} | {turn_deg:g} | {outcome} | "
    return listing("Loads that are not certified", odd, heads, line + "{failures}")


def _small(value: float) -> str:
    """A difference; what rounding leaves has no digits."""
    return formatted(value, "+.0e") if abs(value) > 1e-10 else "rounding"


def _patch(store: Store) -> Part:
    """Three stops of the filmstrip."""
    data = store.table("friction_patch")
    text = prose(f"""## Stick and slip in the patch

The nodes in contact with μ = {float(data["mu"].iloc[0]):g} while the plane is dragged downwards and back. Above:
pressure, and the traction of the plane on the tyre as arrows. Below: which nodes stick and which slip within the last
of {data["steps"].iloc[0]} load steps to that stop; other steps have other zones. The cross is the point of first
contact.""")
    words = "Pressure, tractions, and zones of stick and slip of the patch in mm, at stops of a drag forth and back"
    return joined(text, picture("friction-patch.svg", words, filmstrip(data)))


def _path(store: Store) -> Part:
    """Load steps against accuracy."""
    data, orders = store.table("friction_steps"), store.analysis("friction_step_orders")
    order = {row["quantity"]: row["order"] for row in orders.to_dict("records")}
    text = prose(f"""## Load steps

With friction the answer depends on the way to it, so load steps are part of the answer. Press and drag by 1 mm are cut
into equal steps; errors are relative to the limit that the two finest give at first order. Observed orders of the last
three are {order["friction_N"]:.2f} for the force and {order["dissipation_N_mm"]:.2f} for the dissipation; theory says
1. `footprint solve` follows the path again with every step halved and prints the error that its steps leave.""")
    heads = "steps each | F_t [N] | error | dissipated [N m] | error | operations [10⁹]"
    line = "{steps} | {friction_N:.3f} | {friction_N_error:+.2%} | {work:.4f} | {dissipation_N_mm_error:+.1%}"
    named = data.assign(work=data["dissipation_N_mm"] / 1e3, billions=data["operations"] / 1e9)
    words = "Errors of force and dissipation over the number of load steps, and over operations"
    shown = listing("Press and drag in steps", named, heads, line + " | {billions:.2f}")
    return joined(text, picture("friction-steps.svg", words, path_errors(data)), shown)


CHAPTER = Chapter(
    "friction",
    "Friction",
    "the tyre dragged and turned, stick and slip, what load steps change, and which algorithm to use.",
    friction_page,
    needs=(*TYRE, *FITTED, *OTHERS),
)
