"""An answer of an algorithm, held against what an answer must be before anybody reads it.

What an answer is worth does not enter here: that is for the judge (:mod:`contact.verify`), who sees NaN, too.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from contact.events import Event
from contact.newton.solves import COUNTERS
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Outcome


class ContractError(TypeError):
    """An algorithm has answered with what is no answer; one line that names it."""


def answered(algorithm: ContactAlgorithm, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """What the algorithm answers; what it does not count is 0. Raises ContractError."""
    found = algorithm.solve(problem, start)
    wrong = _wrong(found, len(start.u), len(problem.weights))
    if wrong:
        raise ContractError(f"contact algorithm {algorithm.name!r}: solve returned {wrong}")
    if found.counters.keys() >= {*COUNTERS}:
        return found
    return replace(found, counters={**dict.fromkeys(COUNTERS, 0), **found.counters})


def _wrong(found: object, n: int, m: int) -> str:
    """What is no answer in n unknowns with m candidates; empty for an answer."""
    if not isinstance(found, ContactSolution):
        return f"{_named(found)}, not a ContactSolution"
    for name, kind, word, size in (
        ("u", "f", "floats", n),
        ("pressure", "f", "floats", m),
        ("active", "b", "booleans", m),
    ):
        given = getattr(found, name)
        if not isinstance(given, np.ndarray) or given.dtype.kind != kind or given.shape != (size,):
            return f"{name} as {_named(given)}, not as {word} of shape ({size},)"
    if not isinstance(found.outcome, Outcome):
        return f"outcome as {_named(found.outcome)}, not as an Outcome"
    counts = found.counters
    if not isinstance(counts, Mapping) or not all(
        isinstance(value, int | float | np.number) for value in counts.values()
    ):
        return "counters that are no numbers by name"
    rows = found.history
    if not isinstance(rows, tuple) or not all(isinstance(row, Mapping) for row in rows):
        return "a history that is no tuple of rows"
    if not all(isinstance(row["event"], Event) for row in rows if "event" in row):
        return "a history with an event that is no Event"
    return ""


def _named(value: object) -> str:
    if isinstance(value, np.ndarray):
        return f"{value.dtype} of shape {value.shape}"
    return "None" if value is None else type(value).__name__
