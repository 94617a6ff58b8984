"""The page of the tyre with friction: dragged, turned, its patch, its path, its symmetry, its cost."""

from __future__ import annotations

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.friction.figures import dragged, path_errors, turned
from reports.chapters.friction.filmstrip import filmstrip
from reports.formats import formatted, share
from reports.markdown import Part, commands, fold, joined, listing, machine, picture, prose
from reports.store.tables import Store

NEEDS = ("friction_dragged", "friction_turned", "friction_patch", "friction_steps", "friction_symmetry")
FITTED = ("friction_drag_ends", "friction_turn_ends", "friction_step_orders")
SOLVED = "converged"


def friction_page(store: Store) -> Part:
    """The whole page."""
    sections = (_dragged, _turned, _patch, _path, _symmetry, _cost)
    return joined(_introduction(store), *(section(store) for section in sections))


def _introduction(store: Store) -> Part:
    ends = store.analysis("friction_drag_ends")
    text = prose(f"""# {CHAPTER.title}

The paper's tyre, the whole of it on {ends["mesh"].iloc[0]} elements, is inflated and pressed on a rigid plane with
Coulomb's friction: of the nodal force f across the plane, at most μ f acts along it; less where the node *sticks* to
where it was over the plane when the load step began, and μ f against its way since then where it *slips*. Then the
plane is moved: dragged across the rolling direction, or turned about its normal through the centre of the patch. F_n is
the sum of f, F_t the resultant along the plane, r the distance of a node from the axis of the turn. Nothing is said of
rolling, of heat, or of a coefficient that depends on speed or pressure.""")
    return joined(text, _failures(store))


def _failures(store: Store) -> str:
    """Loads of the drags and turns that the judge refuses, or where the path has ended."""
    moved = pd.concat([store.table(name) for name in ("friction_dragged", "friction_turned")])
    odd = moved[moved["failures"].notna() | (moved["outcome"] != SOLVED)]
    if odd.empty:
        return "No load of these paths is refused by the judge, and none ends before it was asked to."
    heads, line = (
        "μ | drag [mm] | turn [deg] | outcome | refused for",
        "{mu:g} | {drag_mm:g} | {turn_deg:g} | {outcome} | ",
    )
    return listing("Loads that are not certified", odd, heads, line + "{failures}")


def _dragged(store: Store) -> Part:
    """Force over the way of the plane."""
    table, ends, rule = store.table("friction_dragged"), store.analysis("friction_drag_ends"), store.rules()
    full = share(rule["friction_full"], 0)
    text = prose(f"""## Dragged

The force grows while the tyre is sheared; once every candidate slips the same way it is μ F_n on any mesh, with nothing
left to choose. *Full from*: the first stop from
which F_t is within {full} of μ F_n; *all slip from*: the first one from which no candidate sticks.""")
    heads = "μ | F_n pressed [N] | F_n at the end [N] | largest F_t [N] | at [mm] | full from [mm] | all slip from [mm]"
    heads += " | end [mm] | F_t there [N] | F_t/(μ F_n) - 1"
    line = "{mu:g} | {pressed_N:.1f} | {force_N:.1f} | {largest:.2f} | {at:g} | {full:g} | {loose:g} | {last:g}"
    line += " | {value:.2f} | {off:small}"
    made = listing("The drag", ends, heads, line, small=_small)
    words = "Friction over the way of the plane in N and over the normal force, for several coefficients"
    return joined(
        text,
        picture("friction-dragged.svg", words, dragged(table)),
        made,
        fold("All stops", _stops(table, "drag_mm", "drag [mm]")),
        commands(ends["command"]),
    )


def _small(value: float) -> str:
    """A difference; what rounding leaves has no digits."""
    return formatted(value, "+.0e") if abs(value) > 1e-10 else "rounding"


def _stops(table: pd.DataFrame, key: str, head: str) -> str:
    """Every load of a path."""
    named = table.assign(at=table[key].fillna(0.0), off=table["failures"].isna().map({True: "yes", False: "no"}))
    heads = f"μ | {head} | F_n [N] | F_t [N] | torque [N m] | sticking | slipping | dissipated [N m] | iterations"
    heads += " | factorisations | certified"
    line = "{mu:g} | {at:g} | {force_N:.2f} | {friction_N:.2f} | {torque:.3f} | {sticking:.0f} | {slipping:.0f}"
    line += " | {work:.3f} | {newton_iterations:.0f} | {factorisations:.0f} | {off}"
    named = named.assign(torque=named["moment_N_mm"] / 1e3, work=named["dissipation_N_mm"] / 1e3)
    return listing("Stop by stop", named, heads, line)


def _turned(store: Store) -> Part:
    """Parking torque over the angle."""
    table, ends = store.table("friction_turned"), store.analysis("friction_turn_ends")
    full = share(store.rules()["friction_full"], 0)
    text = prose(f"""## Turned on the spot

The torque is that of parking. Once every candidate slips around the axis it is μ Σ f r, but for a factor of the method:
the slip of a step is the chord of its arc, which leans by half of the step against the tangent, so that the torque is
μ Σ f r cos(step/2). *Full from*: the angle from which the torque is within {full} of it; *all slip from*: but for
the candidate in the centre, which has nowhere to slip to.""")
    heads = (
        "μ | largest torque [N m] | at [deg] | full from [deg] | all slip from [deg] | end [deg] | torque there [N m]"
    )
    heads += " | μ Σ f r [N m] | cos(step/2) | ratio - 1"
    line = "{mu:g} | {peak:.3f} | {at:g} | {full:g} | {loose:g} | {last:g} | {torque:.3f} | {limit:.3f} | {chord:.5f}"
    line += " | {off:small}"
    named = ends.assign(peak=ends["largest"] / 1e3, torque=ends["value"] / 1e3, limit=ends["bound"] / 1e3)
    words = "Parking torque over the angle, in N m and over its bound, for several coefficients"
    return joined(
        text,
        picture("friction-turned.svg", words, turned(table)),
        listing("The turn", named, heads, line, small=_small),
        fold("All angles", _stops(table, "turn_deg", "turn [deg]")),
        commands(ends["command"]),
    )


def _patch(store: Store) -> Part:
    """The filmstrip."""
    table = store.table("friction_patch")
    mu = float(table["mu"].iloc[0])
    text = prose(f"""## The patch, stop by stop

The candidates that touch with μ = {mu:g}, each a rectangle of its area where it lies then; the plane is dragged
downwards and back. Above: pressure, and the traction of the plane on the tyre as arrows. Below: who sticks and who
slips within the last of {table["steps"].iloc[0]} load steps to that stop. The cross is where the patch first touched.
Other steps have other zones ([load steps](#load-steps)).""")
    rows = []
    for _, own in table.groupby("stop"):
        pull = own[["friction_y_N", "friction_z_N"]].sum()
        pressure = own["normal_N"] / own["area_mm2"]
        rows.append(
            {
                "drag": own["drag_mm"].iloc[0],
                "touch": len(own),
                "stick": own["sticks"].sum(),
                "F_n": own["normal_N"].sum(),
            }
            | {"along": pull["friction_y_N"], "across": pull["friction_z_N"], "most": pressure.max()}
            | {"slip": own["slip_mm"].max()}
        )
    heads = "stop at [mm] | touching | sticking | F_n [N] | pull along [N] | pull across [N] | largest pressure [MPa]"
    heads += " | largest slip [mm]"
    line = "{drag:g} | {touch} | {stick} | {F_n:.1f} | {along:+.2f} | {across:+.2f} | {most:.3f} | {slip:.3f}"
    words = "Pressure, tractions, and zones of stick and slip of the patch in mm, at the stops of a drag forth and back"
    return joined(
        text,
        picture("friction-patch.svg", words, filmstrip(table)),
        listing("The stops of the pictures", rows, heads, line),
    )


def _path(store: Store) -> Part:
    """Load steps against accuracy."""
    table, orders = store.table("friction_steps"), store.analysis("friction_step_orders")
    text = prose("""## Load steps

With friction the answer depends on the way to it, and load steps are part of the answer: slip is counted from the
beginning of a step. Press and drag are cut into so many steps each; errors are relative to the limit that the two
finest give by Richardson's rule, orders are log2 of the ratio of successive changes, which needs no limit. The
drag and the turn above have one step from stop to stop.""")
    heads = "steps each | F_t [N] | error | dissipated [N m] | error | sticking | operations [10⁹] | outcome"
    line = "{steps} | {friction_N:.3f} | {friction_N_error:+.2%} | {work:.4f} | {dissipation_N_mm_error:+.1%}"
    line += " | {sticking:.0f} of {touching:.0f} | {billions:.2f} | {outcome}"
    named = table.assign(work=table["dissipation_N_mm"] / 1e3, billions=table["operations"] / 1e9)
    named = named.assign(touching=named["sticking"] + named["slipping"])
    fitted = listing(
        "Orders in the size of steps",
        orders.assign(named=orders["quantity"].map({"friction_N": "force", "dissipation_N_mm": "dissipation"})),
        "quantity | order, of the last three | theory",
        "{named} | {order:.2f} | 1",
    )
    seconds = listing("Processor time", table, "steps each | seconds", "{steps} | {cpu_s:.2f}")
    words = "Errors of force and dissipation over the number of load steps, and over operations"
    return joined(
        text,
        picture("friction-steps.svg", words, path_errors(table)),
        listing("Press and drag in steps", named, heads, line),
        fitted,
        machine(seconds),
    )


def _symmetry(store: Store) -> Part:
    """What keeps central symmetry."""
    table = store.table("friction_symmetry")
    text = prose("""## Symmetry

Half a turn about the normal takes the plies of the tyre to themselves. A press and a turn of the plane are symmetric
programmes, and so must be what comes of them, though nothing in the method imposes it; a drag has a direction, and need
not. Differences are those of a
candidate from its image, over the largest force of the kind; images are matched by place.""")
    heads = "programme | candidates | off its image [mm] | normal forces | friction"
    line = "{programme} | {candidates} | {place_mm:.0e} | {normal:.0e} | {friction:.0e}"
    return joined(text, machine(listing("Differences from the image", table, heads, line)))


def _cost(store: Store) -> Part:
    """An iteration with friction beside one without."""
    heading = "## What friction costs"
    if not store.has_table("friction_cost"):
        return joined(heading, "Not measured here.")
    table, rule = store.table("friction_cost"), store.rules()
    bar, each = rule["friction_cost"], rule["friction_factorisations"]
    text = prose(f"""An iteration of Newton with friction beside one of the press without it, all operations of linear
systems and of the choice of states counted. What friction adds: two more directions a candidate to eliminate, a matrix
that is not symmetric where candidates slip, and factorisations where the states change more than one linearisation can
bear. Bars: {bar:g} times the operations, {each:g} factorisations an iteration.""")
    stages = table["stage"] + table["load"].map(lambda at: f" to {at:g} mm")
    over = (table["operations_ratio"] > bar).map({True: "operations", False: ""})
    often = (table["factorisations"] > each).map({True: "factorisations", False: ""})
    named = table.assign(
        step=stages + (table["friction"] == 0).map({True: ", without friction", False: ""}),
        above=[", ".join(filter(None, pair)) for pair in zip(over, often, strict=True)],
    )
    heads = "step | iterations | factorisations an iteration | operations [10⁶] | over that without | above the bar"
    line = "{step} | {iterations} | {factorisations:.2f} | {operations:.0f} | {operations_ratio:.2f} | {above:said}"
    seconds = listing(
        "Processor time of an iteration",
        named,
        "step | seconds | over that without",
        "{step} | {cpu_s:.3f} | {time_ratio:.2f}",
    )
    return joined(heading, text, listing("Cost of an iteration", named, heads, line), machine(seconds))


CHAPTER = Chapter(
    "friction",
    "Friction: the tyre dragged and turned",
    "force, parking torque, zones of stick and slip, what load steps change, and what friction costs.",
    friction_page,
    needs=(*NEEDS, *FITTED),
)
