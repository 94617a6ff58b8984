"""The strain measures over a load that grows: errors against the exact one on the same mesh, and where they pass 1 and
5 %.

An error may change its sign: what is small at the last load may have been large before. So it is said where it first
leaves a level, and how large it ever was.
"""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from studies.analysis.cells.answers import HERE, Answers
from studies.campaigns.report_cells import GROWING

EXACT = "exact"
LEVELS = (0.01, 0.05)
ERROR_COLUMNS = ("scene", "measure", "load", "error")
COLUMNS = ("scene", "measure", "load", "error", "first_1", "first_5", "largest", "largest_at", "command")


def measure_errors(answers: Answers) -> tuple[pd.DataFrame, pd.DataFrame]:
    """ERROR_COLUMNS, a row a load that the exact measure has reached, and COLUMNS, a row a scene and measure.

    error: value over exact value, less one, in COLUMNS that at the last ``load``; NaN where the measure did not get
    there.  first_1, first_5: the load at which |error| first exceeds 1 and 5 %, 0 where it does so at the first load,
    NaN where it never does.  largest: the error of largest size, with its sign, at the load ``largest_at``.
    """
    curves, rows = [], []
    for growing in GROWING:
        found = {each.record["measure"]: each for each in answers.those(growing.cells)}
        if EXACT not in found:
            continue
        exact, name = found[EXACT], growing.quantity
        asked = exact.settings[growing.load]  # a traced curve has points between them
        loads = [step[growing.load] for step in exact.steps]
        loads = [load for load in loads if min(abs(load - each) for each in asked) < HERE]
        for measure, answer in found.items():
            if measure == EXACT:
                continue
            steps = [{growing.load: load} for load in loads]
            errors = np.array([answer.value(name, **at) / exact.value(name, **at) - 1 for at in steps])
            curves += [(growing.scene, measure, load, error) for load, error in zip(loads, errors, strict=True)]
            last = (loads[-1], errors[-1]) if loads else (math.nan, math.nan)
            firsts = (first_beyond(loads, errors, level) for level in LEVELS)
            rows.append((growing.scene, measure, *last, *firsts, *largest(loads, errors), answer.command))
    return pd.DataFrame(curves, columns=list(ERROR_COLUMNS)), pd.DataFrame(rows, columns=list(COLUMNS))


def first_beyond(loads: list[float], errors: np.ndarray, level: float) -> float:
    """The load at which |error| first exceeds the level, between two loads by linear interpolation of the error.

    0 when it does so at the first load already; NaN when it never does. Loads that were not reached are left out.
    """
    load, error = (np.asarray(loads, float)[~np.isnan(errors)], errors[~np.isnan(errors)])
    beyond = np.flatnonzero(np.abs(error) > level)
    if len(beyond) == 0:
        return math.nan
    i = int(beyond[0])
    if i == 0:
        return 0.0
    target = math.copysign(level, error[i])
    return float(load[i - 1] + (load[i] - load[i - 1]) * (target - error[i - 1]) / (error[i] - error[i - 1]))


def largest(loads: list[float], errors: np.ndarray) -> tuple[float, float]:
    """The error of largest size, with its sign, and its load; NaN when no load was reached."""
    if np.isnan(errors).all():
        return math.nan, math.nan
    i = int(np.nanargmax(np.abs(errors)))
    return float(errors[i]), float(loads[i])
