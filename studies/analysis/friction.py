"""What the tables of friction come to: the ends of a drag and of a turn, orders of errors, a sum by algorithm.

They are those of :mod:`studies.experiments.friction`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
import pandas as pd

from studies.experiments.friction.scenes import DELTA, MESH
from studies.solving.refinement.richardson import holds_from, power_of
from studies.solving.result import SOLVED, UNSUPPORTED

FULL = 0.01  # a force or a torque is full once it is so near to its bound, and stays so
FLOOR = 1e-8  # an error below this has nothing left that could fall: rounding, or what decides between states
LAST = 4  # an order is fitted to so many of the finest
FIRST = "semismooth"  # which all other algorithms are compared with
COST_BARS = {"friction_cost": 2.5, "friction_factorisations": 1.2}  # over a step without friction; an iteration
GRECO = 5e-4  # of a slip of that plate


def ends(table: pd.DataFrame, key: str) -> pd.DataFrame:
    """A row a coefficient of a drag (``key`` drag_mm) or a turn (turn_deg): how full its force or torque becomes.

    pressed_N, force_N: normal, before and at the last stop.  value, bound: at the last stop, force [N] or torque
    [N mm].  off: value over bound, less 1, of a turn with cos(step/2), for the slip of a step is the chord of its arc.
    largest, at: of the value, and the stop.  full: first stop from which it is within FULL of that bound.  loose: first
    stop from which none sticks but the centre of a turn; NaN where there is none.
    """
    names = ("friction_N", "bound_N") if key == "drag_mm" else ("moment_N_mm", "moment_bound_N_mm")
    rows = []
    for mu, own in table.groupby("mu", sort=False):
        moved = own[own[key].notna()]
        at, value, bound = (moved[name].to_numpy(float) for name in (key, *names))
        chord = np.ones(len(at)) if key == "drag_mm" else np.cos(np.deg2rad(np.diff(at, prepend=0.0)) / 2)
        off = value / (bound * chord) - 1
        kept = 0 if key == "drag_mm" else 1
        peak = int(np.argmax(value))
        rows.append(
            {"mu": mu, "loads": len(own), "certified": int(own["failures"].isna().sum())}
            | {"pressed_N": own["force_N"].iloc[0], "force_N": moved["force_N"].iloc[-1], "last": at[-1]}
            | {"value": value[-1], "bound": bound[-1], "off": off[-1]}
            | {"largest": value[peak], "at": at[peak], "full": _from(at, np.abs(off) <= FULL)}
            | {"loose": _from(at, moved["sticking"].to_numpy(float) <= kept)}
            | {"mesh": MESH, "command": _command(float(str(mu)), key, at)}
        )
    return pd.DataFrame(rows)


drag_ends, turn_ends = (partial(ends, key=key) for key in ("drag_mm", "turn_deg"))


def _command(mu: float, key: str, stops: np.ndarray) -> str:
    """What solves the path of a coefficient."""
    way = ["drag_deg=90"] if key == "drag_mm" else []
    settings = [f"delta_mm={DELTA:g}", f"mu={mu:g}", f"{key}={','.join(f'{at:g}' for at in stops)}", *way]
    options = " ".join(f"--set {each}" for each in settings)
    return f"footprint solve tyre --model full --mesh {MESH} {options} --out DIR"


def _from(at: np.ndarray, holds: np.ndarray) -> float:
    """The first stop from which something holds to the end; NaN where it does not hold at the end."""
    first = holds_from(holds)
    return float(at[first]) if first < len(at) else np.nan


def orders(name: str, table: pd.DataFrame, cases: Sequence[str], of: str, theory: Mapping[str, int]) -> pd.DataFrame:
    """A row a case and error of a family: the error with the finest number, its order and that of theory.

    cases: columns that tell cases apart.  of: that of the number.  theory: the order of each error.
    The order is fitted to the LAST finest; NaN where an error is below FLOOR on one of them.
    """
    rows = []
    for _, own in table.groupby(list(cases), sort=False):
        finest = own.sort_values(of).iloc[-LAST:]
        for error, order in theory.items():
            n, errors = finest[of].to_numpy(float), finest[error].to_numpy(float)
            fitted = -power_of(n, errors) if np.min(np.abs(errors)) > FLOOR else np.nan
            row = {"family": name, "quantity": error.removesuffix("_error"), "error": errors[-1]}
            rows.append(row | {"order": fitted, "theory": order})
    return pd.DataFrame(rows)


def step_orders(steps: pd.DataFrame) -> pd.DataFrame:
    """Orders of the force and the dissipation in the size of load steps, from three numbers of steps, each twice the
    one before: log2 of the ratio of their differences, for which no limit has to be guessed.

    first_error, error: with the fewest and the most steps, off the limit that the two finest give at first order.
    """
    own = steps.sort_values("steps")
    rows = []
    for name in ("friction_N", "dissipation_N_mm"):
        change = np.diff(own[name].to_numpy(float))
        observed = np.log2(np.abs(change[:-1] / change[1:]))
        errors = own[f"{name}_error"]
        row = {"quantity": name, "order": observed[-1]}
        rows.append(row | {"first_error": errors.iloc[0], "error": errors.iloc[-1]})
    return pd.DataFrame(rows)


def by_algorithm(agreement: pd.DataFrame) -> pd.DataFrame:
    """A row an algorithm: cases that it ends on (solved), and agrees on; its errors and costs.

    exact: asked for no regularisation.  refused: cases that it says it does not apply to.  other_steps: solved cases on
    which it has cut load steps otherwise than FIRST, which is another path.  iterations, operations, seconds: over
    those of FIRST, the median of cases that both solve in the same steps.
    """
    first = agreement[agreement["algorithm"] == FIRST].set_index("case")
    rows = []
    for name, own in agreement.groupby("algorithm", sort=False):
        solved = own[own["outcome"].isin(SOLVED)]
        beside = first.loc[solved["case"]].reset_index()
        same = solved["substeps"].to_numpy() == beside["substeps"].to_numpy()
        both = solved.loc[same & beside["outcome"].isin(SOLVED).to_numpy()]
        over = both.set_index("case")[["iterations", "operations", "cpu_s"]]
        ratios = (over / first.loc[over.index, over.columns]).median()
        refused = int((own["outcome"] == UNSUPPORTED).sum())
        row = {"algorithm": name, "cases": len(own), "exact": int(np.isinf(own["epsilon"]).all())}
        row |= {"solved": len(solved), "refused": refused, "failed": len(own) - len(solved) - refused}
        row |= {"agrees": int(own["agrees"].sum()), "other_steps": int(np.sum(~same))}
        names = ("iterations_ratio", "operations_ratio", "seconds_ratio")
        rows.append(row | {"both": len(both)} | dict(zip(names, ratios, strict=True)))
    return pd.DataFrame(rows)
