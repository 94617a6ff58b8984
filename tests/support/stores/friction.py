"""Made-up tables of friction: bounds are met, orders are chosen, one algorithm fails and one takes other steps."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

MUS, PRESSED_N = (0.25, 0.5), 1000.0
DRAGS, TURNS = (1.0, 2.0, 8.0), (1.0, 2.0, 12.0)
ARM = 20.0  # mm
CASES, LOST, ELSEWHERE = ("tyre dragged", "ring", "strip"), "tyre dragged", "ring"
EXACT, NAIVE, SOFT = ("semismooth", "qp"), "trial-and-error", "regularised"


def made_up_friction() -> dict[str, pd.DataFrame]:
    """All tables of the two pages by name."""
    return {
        "friction_dragged": moved("drag_mm", DRAGS),
        "friction_turned": moved("turn_deg", TURNS),
        "friction_patch": patch(),
        "friction_steps": steps(),
        "friction_symmetry": symmetry(),
        "friction_cost": cost(),
        "friction_agreement": agreement(),
        "friction_greco": greco(),
        "friction_klarbring": klarbring(),
        "friction_strip": _errors(
            {"steps": (1,)}, "elements", {"end": 2, "back": 2, "loop": 2, "counted": 1}, ("front",)
        ),
        "friction_drum": _errors({"side": ("on", "inside")}, "elements", {"end": 2, "slip": 2}),
        "friction_capstan": _errors({"side": ("on",), "mu": (0.5,), "theta_rad": (2.0,)}, "elements", {"": 2}),
        "friction_parking": _errors(
            {"pressure": ("uniform",), "core": (1 / 3,)}, "rings", {"core": 2, "moment": 2, "loop": 2}
        ),
        "friction_path": _errors({"case": ("springs alike",)}, "steps", {"end": 1, "work": 1}),
        "friction_rolling": rolling(),
        "friction_joint_motion": joint_motion(),
        "friction_tied": tied(),
        "friction_crushed_ring": crushed(),
        "friction_public": public(),
    }


def moved(key: str, stops: Sequence[float]) -> pd.DataFrame:
    """Half of the bound at the first stop, 0.98 at the second, all of it at the last; a turn has the chord, too."""
    rows = []
    for mu in MUS:
        bound, sizes = mu * PRESSED_N, np.diff(stops, prepend=0.0)
        shares = (0.0, 0.5, 0.98, 1.0)
        for k, (stop, share) in enumerate(zip((math.nan, *stops), shares, strict=True)):
            turned = key == "turn_deg" and k > 0
            chord = math.cos(math.radians(sizes[k - 1]) / 2) if turned else 1.0
            row = {"mu": mu, "delta_mm": 10.0, "force_N": PRESSED_N, "bound_N": bound, key: stop}
            row |= {"friction_N": 0.0 if turned else share * bound, "moment_bound_N_mm": bound * ARM}
            row |= {"moment_N_mm": share * bound * ARM * chord, "sticking": [9, 5, 1, 0][k], "slipping": 4 + k}
            row |= {"dissipation_N_mm": 10.0 * k, "newton_iterations": 4, "factorisations": 5, "substeps": 1}
            rows.append(row | {"failures": None, "outcome": "converged"})
    return pd.DataFrame(rows)


def patch() -> pd.DataFrame:
    """Three by three candidates 10 and 5 mm apart, whose middle row sticks; three stops, forth and back to 0."""
    rows = []
    for stop, drag in enumerate((0.0, 1.0, 0.0)):
        for y, z in product((-10.0, 0.0, 10.0), (-5.0, 0.0, 5.0)):
            pull = (0.0, -2.0, 1.0)[stop]
            rows.append(
                {"candidate": len(rows), "normal_N": 10.0, "x_mm": 0.0, "y_mm": y, "z_mm": z - drag}
                | {"friction_x_N": 0.0, "friction_y_N": 0.0, "friction_z_N": pull, "slip_mm": 0.1, "area_mm2": 50.0}
                | {"sticks": int(z == 0.0), "stop": stop, "drag_mm": drag, "mu": 0.5, "steps": 8}
            )
    return pd.DataFrame(rows)


def steps() -> pd.DataFrame:
    """First order: force 100 (1 - 0.04/n), dissipation 50 (1 + 1/n)."""
    count = np.array([1, 2, 4, 8])
    force, work = 100 * (1 - 0.04 / count), 50 * (1 + 1 / count)
    table = pd.DataFrame({"steps": count, "friction_N": force, "dissipation_N_mm": work, "outcome": "converged"})
    table = table.assign(operations=10**9 * count, cpu_s=1.0 * count, sticking=2.0, slipping=8.0)
    return table.assign(friction_N_error=-0.04 / count, dissipation_N_mm_error=1 / count)


def symmetry() -> pd.DataFrame:
    """A drag breaks it."""
    rows = [("pressed", 1e-14, 2e-14), ("turned", 2e-14, 3e-14), ("dragged", 0.25, 0.5)]
    table = pd.DataFrame(rows, columns=["programme", "normal", "friction"])
    return table.assign(candidates=9, place_mm=1e-15, outcome="converged")


def cost() -> pd.DataFrame:
    """The first drag is above both bars."""
    rows = [("press", 0, 10.0, 1.0, 1.0), ("press", 1, 10.0, 1.2, 2.0), ("drag", 1, 0.5, 1.5, 3.0)]
    table = pd.DataFrame(rows, columns=["stage", "friction", "load", "factorisations", "operations_ratio"])
    table = table.assign(
        mesh="42x40", outcome="converged", iterations=5, time_ratio=1 + 0.5 * (table["operations_ratio"] - 1)
    )
    return table.assign(operations=100 * table["operations_ratio"], cpu_s=0.1 * table["time_ratio"])


def agreement() -> pd.DataFrame:
    """NAIVE is lost on one case and takes 8 steps on another; SOFT is off by 1e-4 everywhere."""
    rows = []
    for case, name in product(CASES, (NAIVE, "semismooth", SOFT, "qp")):
        lost, other = name == NAIVE and case == LOST, name == NAIVE and case == ELSEWHERE
        error = math.nan if lost else 0.25 if other else 1e-4 if name == SOFT else 1e-12 * (name != "semismooth")
        row = {"case": case, "algorithm": name, "epsilon": 1e4 if name == SOFT else math.inf}
        row |= {
            "outcome": "cap-hit" if lost else "converged",
            "reason": "the states repeat themselves" if lost else None,
        }
        row |= {"loads": 0 if lost else 2, "judged": 0 if lost else 2, "substeps": 0 if lost else 8 if other else 2}
        row |= {"states": 3 if other else 0, "force_error": error, "agrees": int(error <= 1e-8)}
        row |= {"finer_error": 2e-4 if name == SOFT and case != LOST else math.nan}
        row |= {"iterations": 30 if name == NAIVE else 10, "factorisations": 20 if name == "qp" else 10}
        rows.append(row | {"operations": 150.0 if name == "qp" else 100.0, "cpu_s": 1.0})
    return pd.DataFrame(rows)


def greco() -> pd.DataFrame:
    """Errors of 1e-4 on the finest mesh; NAIVE cycles."""
    rows = []
    for n, name in product((8, 16), (NAIVE, *EXACT)):
        lost = name == NAIVE
        row = {"elements": n, "algorithm": name, "outcome": "cycling" if lost else "converged"}
        row |= {
            "newton_iterations": 3,
            "factorisations": 4,
            "operations": 50.0,
            "error": 1.0 if lost else 0.0256 / n**2,
        }
        rows.append(row | {"slip_0": 0.0286, "slip_5": 0.0229, "friction_N": -1405.0})
    return pd.DataFrame(rows)


def klarbring() -> pd.DataFrame:
    """One answer that NAIVE does not find, three of which all find one, and none."""
    cases = {"one": (0.5, 1, "stick"), "three": (1.5, 3, "open, stick, slip +"), "nothing": (2.0, 0, None)}
    rows = []
    for (case, (coupling, count, which)), name in product(cases.items(), (NAIVE, *EXACT)):
        lost = count == 0 or (name == NAIVE and case == "one")
        actual = None if lost else "stick" if case == "one" else "open"
        row = {"case": case, "mu_Knt_over_Ktt": coupling, "answers": count, "which": which, "algorithm": name}
        rows.append(row | {"outcome": "cycling" if lost else "converged", "found": actual})
    return pd.DataFrame(rows)


def _errors(
    cases: Mapping[str, Sequence[Any]], number: str, powers: Mapping[str, int], exact: Sequence[str] = ()
) -> pd.DataFrame:
    """0.1 n^-power of each, on four meshes; nothing of what is ``exact``."""
    rows = []
    for case in product(*cases.values()):
        for n in (10, 20, 40, 80):
            named = {f"{name}_error".lstrip("_"): 0.1 * float(n) ** -power for name, power in powers.items()}
            rows.append(
                dict(zip(cases, case, strict=True)) | {number: n} | named | {f"{e}_error": 1e-15 for e in exact}
            )
    return pd.DataFrame(rows)


def rolling() -> pd.DataFrame:
    """With little friction a node slips."""
    table = pd.DataFrame({"mu": [0.1, 0.5], "slips": [4, 0], "dissipated_N_mm": [0.1, 1e-15]})
    table = table.assign(nodes=8, step_mm=1.0, outcome="converged", hub_error_mm=1e-14, middle_error_mm=2e-14)
    return table.assign(radius_mm=49.8, bars_mm=49.8, radius_error=1e-6)


def joint_motion() -> pd.DataFrame:
    """Nothing changes but when the plane moves alone."""
    table = pd.DataFrame({"step": ["loaded", "together", "alone"], "change_N": [0.0, 1e-11, 2e-3]})
    table = table.assign(load="pushed", turn_rad=[0.0, 3.0, 1e-4], way_mm=[0.0, 500.0, 1e-3], friction_N=13.5)
    return table.assign(normal_change_N=table["change_N"], dissipation_N_mm=[0.0, 1e-13, 1e-6], outcome="converged")


def tied() -> pd.DataFrame:
    """An answer that is found, and none."""
    table = pd.DataFrame({"load": ["uniform", "lifting"], "answers": [1, 0], "outcome": ["converged", "cycling"]})
    table = table.assign(element="Q1", elements=4, nodes=4, tied=[2.0, np.nan], otherwise=[0.0, np.nan])
    return table.assign(difference=[1e-15, np.nan], iterations=1)


def crushed() -> pd.DataFrame:
    """Friction adds 1 and 2 %, as elsewhere twice of it; of the last state nothing else is known."""
    table = pd.DataFrame({"delta_mm": [10.0, 20.0, 30.0], "change": [0.01, 0.02, 0.05], "smooth_N": [8.0, 16.0, 24.0]})
    table = table.assign(scene="crushed-ring", mu=0.4, force_N=table["smooth_N"] * (1 + table["change"]))
    return table.assign(aster_change=[0.02, 0.04, np.nan], failures=None)


def public() -> pd.DataFrame:
    """Two problems: one has an answer by both, one by nobody, and qp claims it."""
    rows = [
        ("a", "semismooth", "converged", True),
        ("a", "qp", "converged", True),
        ("b", "semismooth", "cycling", None),
        ("b", "qp", "converged", False),
        ("no problem", None, None, None),
    ]
    table = pd.DataFrame(rows, columns=["problem", "algorithm", "outcome", "certified"])
    return table.assign(contacts=[1, 1, 40, 40, np.nan], seconds=0.1)
