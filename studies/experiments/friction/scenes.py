"""Scenes with friction: the tyre pressed, dragged and turned on the spot; load steps, symmetry, cost; all algorithms.

All are solved as any scene is, by its settings ``mu``, ``drag_mm`` and ``turn_deg``. Forces are those of a whole tyre.
The algorithms solve every scene with contact in the same load steps: do they agree, at what cost? All are asked for the
exact law, epsilon = inf, but for that of springs, which has none: its error is shown.
"""

import time
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd

from contact.catalogue import ALGORITHMS, is_exact
from contact.coulomb import State
from contact.operations import SPENT
from contact.problem import ContactAlgorithm
from studies.ask.scene import Stage
from studies.ask.settings import configured
from studies.experiments import Row, tabulated
from studies.scenes.complete import complete
from studies.scenes.data import reference_rows
from studies.scenes.friction_readings import FORCES, FRICTION
from studies.scenes.walk import walk
from studies.solving.friction_stages import Stages
from studies.solving.result import Result
from studies.solving.solve import solve

MESH, COARSE, DELTA = "42x40", "14x14", 10.0  # of the tyre, and where its load steps are counted; mm
MU, RING_MU = 0.5, 0.4  # where no others are named
COEFFICIENTS = (0.25, 0.5, 1.0)
DRAGS = (0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 16.0, 64.0)  # mm
TURNS = (0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, *range(20, 100, 10))  # deg: the last ones alike
PATCH_STOPS, PATCH_STEPS = (0.5, 1.0, 2.0, 4.0, 0.0), 8  # mm: and back; load steps from stop to stop
STEPS = (1, 2, 4, 8, 16, 32)
COSTED = (0.5, 1.0, 2.0, 4.0, 8.0)  # mm: a drag whose cost is counted
PROGRAMMES: dict[str, dict[str, object]] = {  # whose symmetry is asked for
    "pressed": {},
    "turned": {"turn_deg": (1.0, 4.0)},
    "dragged": {"drag_mm": (1.0,)},
}
CONTACT, REPEATS = "semismooth", {MESH: 3, "60x56": 1}  # by mesh, of a step whose cost is counted


def solved(scene: str, settings: Mapping[str, object], mesh: str | None, **options: Any) -> Result:
    """The result of a request."""
    return solve(*complete(scene, settings, mesh, **options))


def rubbed(mesh: str, moves: Mapping[str, object], mu: float = MU, steps: int = 1) -> Result:
    """The whole tyre pressed with friction, then its plane moved; a drag is across."""
    across = {"drag_deg": 90.0} if "drag_mm" in moves else {}
    return solved("tyre", {"delta_mm": DELTA, "mu": mu, **moves, **across}, mesh, model="full", steps=steps)


def rows(result: Result) -> Iterator[Row]:
    """What friction has to say at each load, and whether the judge has certified it."""
    for step in result.steps:
        seen = {key: step[key] for key in ("delta_mm", "drag_mm", "turn_deg", "force_N", *FORCES) if key in step}
        spent = {key: step[key] for key in ("newton_iterations", "factorisations", "substeps")}
        yield {**seen, **spent, "failures": " ".join(step["failures"]), "outcome": result.verdict}


@tabulated
def dragged_table() -> Iterator[Row]:
    """The tyre pressed, then its plane dragged across; the force and who slips at each stop, by coefficient."""
    for mu in COEFFICIENTS:
        yield from ({"mu": mu, **row} for row in rows(rubbed(MESH, {"drag_mm": DRAGS}, mu)))


@tabulated
def turned_table() -> Iterator[Row]:
    """The tyre pressed, then its plane turned under it: the parking torque at each stop, by coefficient.

    Slip is the chord of the arc of its step: once all slip, step by step of d, the torque is mu sum f r cos(d/2).
    """
    for mu in COEFFICIENTS:
        yield from ({"mu": mu, **row} for row in rows(rubbed(MESH, {"turn_deg": TURNS}, mu)))


def patch_table() -> pd.DataFrame:
    """The candidates that touch at each stop of a drag forth and back: place, forces, slip, and whether they stick.

    In PATCH_STEPS from stop to stop: pressed in one, all would slip away from the middle.
    """
    tables = rubbed(MESH, {"drag_mm": PATCH_STOPS}, steps=PATCH_STEPS).tables[FRICTION]
    stops = (0.0, *PATCH_STOPS)
    frames = [
        table.frame().assign(stop=k, drag_mm=stops[k], mu=MU, steps=PATCH_STEPS) for k, table in enumerate(tables)
    ]
    return pd.concat(frames, ignore_index=True).drop(columns="delta_mm")


def steps_table() -> pd.DataFrame:
    """Force and dissipation of the tyre pressed and dragged by 1 mm, in so many steps each: the error of the path.

    error: of a value, from the one that the two finest give by Richardson's rule at first order.
    """
    counts = []
    for count in STEPS:
        result = rubbed(COARSE, {"drag_mm": 1.0}, steps=count)
        *_, last = rows(result)
        operations = sum(result.work.values())
        counts.append({"steps": count, **last, "operations": operations, "cpu_s": result.timing["cpu"]})
    table = pd.DataFrame(counts)
    for name in ("friction_N", "dissipation_N_mm"):
        *_, before, finest = table[name]
        table[f"{name}_error"] = table[name] / (2 * finest - before) - 1
    return table


@tabulated
def crushed_table() -> Iterator[Row]:
    """The crushed ring with friction and without, shell and solid, beside what another program finds friction to add.

    change, aster_change: of the force by friction [-]; that of Code_Aster is by another law of the material.
    """
    rows_read = reference_rows("contact_crushed_ring.csv")
    aster = {row["delta_mm"]: row["aster_friction_N"] / row["aster_N"] - 1 for row in rows_read}
    for scene in ("crushed-ring", "crushed-ring-solid"):
        smooth, rough = (solved(scene, {"mu": mu}, None) for mu in (0.0, RING_MU))
        for one, other in zip(smooth.steps, rough.steps, strict=True):
            change = other["force_N"] / one["force_N"] - 1
            row = {"scene": scene, "mu": RING_MU, "delta_mm": one["delta_mm"], "change": change}
            failures = " ".join(one["failures"] + other["failures"])
            yield {**row, "aster_change": aster.get(one["delta_mm"], np.nan), "failures": failures}


@tabulated
def symmetry_table() -> Iterator[Row]:
    """What friction keeps of central symmetry: a turn by 180 degrees about the normal takes plies to plies.

    pressure, traction: largest difference between a candidate and its image, over the largest; for the press, the press
    and a turn of the plane, which are symmetric programmes, and for a drag, which is not.
    """
    for programme, moves in PROGRAMMES.items():
        result = rubbed(MESH, moves)
        yield {"programme": programme, **central(result.tables[FRICTION][-1].frame()), "outcome": result.verdict}


def central(nodes: pd.DataFrame) -> dict[str, float]:
    """Largest differences of forces from those of the image (-y, -z), over the largest force of the kind."""
    place = nodes[["y_mm", "z_mm"]].to_numpy()
    image = np.argmin(np.linalg.norm(place[:, None] + place[None], axis=2), axis=1)
    normal = nodes["normal_N"].to_numpy()
    pull = nodes[["friction_y_N", "friction_z_N"]].to_numpy()
    return {
        "normal": float(np.max(np.abs(normal - normal[image])) / normal.max()),
        "friction": float(np.max(np.linalg.norm(pull + pull[image], axis=1)) / np.linalg.norm(pull, axis=1).max()),
    }


def cost_table() -> pd.DataFrame:
    """Each step on each mesh: iterations, factorisations, operations [million] and CPU time [s] an iteration.

    operations_ratio, time_ratio: to those of the press without friction, an iteration.  Times are the least of REPEATS,
    each of them with both, so that a machine that slows down slows both.
    """
    return pd.concat([_cost_on(mesh, repeats) for mesh, repeats in REPEATS.items()], ignore_index=True)


def _cost_on(mesh: str, repeats: int) -> pd.DataFrame:
    runs = [list(_both(mesh)) for _ in range(repeats)]
    table = pd.DataFrame(runs[0])
    table["cpu_s"] = [min(run[k]["cpu_s"] for run in runs) for k in range(len(table))]
    plain = table.iloc[0]
    table["operations_ratio"] = table["operations"] / plain["operations"]
    table["time_ratio"] = table["cpu_s"] / plain["cpu_s"]
    table.insert(0, "mesh", mesh)
    return table


def _both(mesh: str) -> Iterator[Row]:
    for friction in ({}, {"mu": MU, "drag_mm": COSTED, "drag_deg": 90.0}):
        scene, request = complete("tyre", {"delta_mm": DELTA, **friction}, mesh, contact=CONTACT, model="full")
        stages: Iterable[Stage] = scene.build(request).stages()
        stages = Stages(stages, request.settings) if friction else stages
        yield from _steps(stages, configured(CONTACT, request.settings), rubbed=bool(friction))


def _steps(stages: Iterable[Stage], algorithm: ContactAlgorithm, *, rubbed: bool) -> Iterator[Row]:
    spent, clock = sum(SPENT.values()), time.process_time()
    for visited in walk(stages, algorithm):
        counters = visited.point.solution.counters
        now, at = sum(SPENT.values()), time.process_time()
        iterations = counters["newton_iterations"]
        if len(visited.problem.weights):
            yield {
                "stage": visited.stage.name,
                "friction": int(rubbed),
                "load": visited.point.requested,
                "outcome": visited.point.outcome.word,
                "iterations": int(iterations),
                "factorisations": counters["factorisations"] / iterations,
                "operations": (now - spent) / iterations / 1e6,
                "cpu_s": (at - clock) / iterations,
            }
        spent, clock = sum(SPENT.values()), time.process_time()


AGREED, TOLERANCE = 1e-8, 1e-11  # of the largest force; of the residual, of which far less than AGREED is left
ACROSS = {"drag_deg": 90.0}
CASES: dict[str, tuple[str, str, Mapping[str, object]]] = {
    "tyre dragged and back": ("tyre", "14x12", {"delta_mm": 8.0, "mu": 0.5, "drag_mm": (0.5, 2.0, 8.0, 0.0), **ACROSS}),
    "tyre turned": ("tyre", "14x12", {"delta_mm": 8.0, "mu": 0.5, "turn_deg": (0.5, 2.0, 8.0)}),
    "tyre pressed, mu = 1.5": ("tyre", "14x12", {"delta_mm": 8.0, "mu": 1.5}),
    "tyre on a drum": ("tyre", "14x12", {"delta_mm": 8.0, "mu": 0.5, "foundation": "drum"}),
    "plate dragged under pressure": (
        "panel",
        "8x8",
        {"shape": "plate", "mu": 0.4, "delta_mm": 0.5, "drag_mm": (0.02, 0.1, -0.1)},
    ),
    "panel under a ball that turns": ("panel", "6x6", {"mu": 0.3, "foundation": "ball", "turn_deg": (1.0, 5.0)}),
    "crushed ring": ("crushed-ring", "1x32", {"mu": 0.4}),
    "crushed ring, solid": ("crushed-ring-solid", "2x16", {"mu": 0.4}),
    "ring": ("ring", "1x32", {"mu": 0.4}),
    "strip on a plane": ("strip-contact", "32x1", {"mu": 0.4}),
    "plate on a plane": ("plate-contact", "32x1", {"mu": 0.4}),
    "heavy strip": ("heavy-strip", "32x1", {"mu": 0.4}),
}


@tabulated
def agreement_table() -> Iterator[Row]:
    """A row a case and algorithm, compared with semismooth at all loads that both have reached.

    force_error: largest difference of a normal or tangential force of a candidate, over the largest force there.
    states: candidates of all loads that one has open, sticking or slipping and the other otherwise.  agrees: the same
    states, and forces to AGREED.
    finer_error: of a law of springs, force_error on twice the elements each way; NaN where one of the two does not
    converge there, or they take other load steps.
    """
    for case in CASES:
        yield from _compared(case)


def _compared(case: str) -> Iterator[Row]:
    scene, mesh, settings = CASES[case]
    settings = {**settings, "tolerance": TOLERANCE}
    first = solved(scene, settings, mesh, contact="semismooth")
    for name in ALGORITHMS:
        law = {"epsilon": np.inf} if is_exact(name) else {}
        result = solved(scene, {**settings, **law}, mesh, contact=name) if name != "semismooth" else first
        reached = min(len(result.steps), len(first.steps))
        errors = [_difference(result, first, k) for k in range(reached)]
        states, error = sum(each[0] for each in errors), max((each[1] for each in errors), default=np.nan)
        yield {
            "case": case,
            "algorithm": name,
            "epsilon": result.request.number("epsilon"),
            "outcome": result.verdict,
            "reason": result.reason or result.unsupported,
            "substeps": sum(step["substeps"] for step in result.steps),
            "states": states,
            "force_error": error,
            "agrees": int(result.verdict == "converged" and states == 0 and error <= AGREED),
            "finer_error": np.nan if is_exact(name) else _on_finer_mesh(case, name),
            "iterations": result.counters.get("newton_iterations", 0),
            "operations": sum(result.work.values()) / 1e6,
            "cpu_s": result.timing["cpu"],
        }


def _on_finer_mesh(case: str, springs: str) -> float:
    scene, mesh, settings = CASES[case]
    n1, n2 = (2 * int(n) if int(n) > 1 else 1 for n in mesh.split("x"))
    soft, hard = (
        solved(scene, {**settings, "tolerance": TOLERANCE}, f"{n1}x{n2}", contact=name)
        for name in (springs, "semismooth")
    )
    ours, theirs = ([step["substeps"] for step in each.steps] for each in (soft, hard))
    if any(each.verdict != "converged" for each in (soft, hard)) or ours != theirs:
        return np.nan
    return max(_difference(soft, hard, k)[1] for k in range(len(ours)))


def _difference(one: Result, other: Result, load: int) -> tuple[int, float]:
    """Candidates in another state, and the largest difference of forces over the largest, at a load."""
    mine, theirs = (_nodes(result, load) for result in (one, other))
    touch = mine.index.union(theirs.index)
    ours, others = (nodes.reindex(touch).fillna(0.0) for nodes in (mine, theirs))
    forces = ["normal_N", "friction_x_N", "friction_y_N", "friction_z_N"]
    largest = float(np.linalg.norm(others[forces].to_numpy(), axis=1).max(initial=0.0)) or 1.0
    off = np.linalg.norm((ours[forces] - others[forces]).to_numpy(), axis=1).max(initial=0.0)
    return int((ours["state"] != others["state"]).sum()), float(off) / largest


def _nodes(result: Result, load: int) -> pd.DataFrame:
    nodes = result.tables["friction"][load].frame().set_index("candidate")
    return nodes.assign(state=np.where(nodes["sticks"] == 1, State.STICK, State.SLIP))
