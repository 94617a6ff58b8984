"""What the algorithms share: each is a Newton iteration with a way of its own to choose the contact set.

An answer of one is held against what an answer must be before anybody reads it. What it is worth does not enter here:
that is for the judge (:mod:`contact.verify`), who sees NaN, too.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import TYPE_CHECKING, ClassVar, cast

import numpy as np

from contact.events import Event
from contact.newton.loop import MOST_UPDATES
from contact.newton.solves import COUNTERS, RESIDUAL_TOLERANCE
from contact.newton.step import NewtonRun
from contact.parameters import SHARED, Parameter
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Outcome
from contact.solvers.sparse import AUTO

if TYPE_CHECKING:
    from contact.newton.friction_run import FrictionalRun

FEW = 10  # iterations and updates of a step that is to be easy


@dataclass(frozen=True)
class NewtonAlgorithm:
    """The fields of every algorithm, and the run that counts what its iteration spends.

    epsilon [MPa/mm]: infinity enforces the constraint exactly; with friction it is that of springs in both directions,
    f = w epsilon <-g> and, in stick, t = -w epsilon s.  solver: of the linear systems.  tolerance: of the
    residual, relative to the forces in balance.
    Of its fields a user sets those in ``parameters``. The others (max_iterations and its like) only say when a solve is
    given up, how fast a penalty grows or whether a backend polishes: no answer depends on them, and a test that wants a
    failure sets them in Python.
    springs: whether its law needs a finite epsilon.
    friction: whether ``solve`` takes problems that have some. With an infinite epsilon candidates are held by unknowns
    of their own then: where they have none the outcome is REFUSED.
    """

    epsilon: float = np.inf
    max_iterations: int = 40
    solver: str = AUTO
    tolerance: float = RESIDUAL_TOLERANCE
    max_updates: int = MOST_UPDATES
    parameters: ClassVar[tuple[Parameter, ...]] = SHARED
    friction: ClassVar[bool] = False
    springs: ClassVar[bool] = False

    def supports(self, problem: ContactProblem) -> str | None:
        """Applies to every problem without friction; with friction, where the algorithm with its settings solves it."""
        return (
            None
            if problem.coulomb is None
            else problem.unfit_for_friction or unfit_with_friction(cast(ContactAlgorithm, self))
        )

    def run(self, problem: ContactProblem) -> NewtonRun:
        """A new run of this algorithm on a problem."""
        return NewtonRun(problem, self.epsilon, self.solver, self.tolerance)

    def rubbing(self, problem: ContactProblem, start: ContactSolution, *, lawful: bool = True) -> FrictionalRun:
        """A new run on a problem with friction; raises ValueError where that has no place in it."""
        if problem.unfit_for_friction:
            raise ValueError(problem.unfit_for_friction)
        from contact.newton.friction_run import FrictionalRun  # no solve without friction loads it

        return FrictionalRun.of(self.run(problem), start, lawful=lawful)


def frictionless_parameters(algorithm: ContactAlgorithm | type[ContactAlgorithm]) -> tuple[str, ...]:
    """Those that mean nothing with friction: semismooth's c, the system of qp and lcp, the method of lcp (Lemke's)."""
    return tuple(parameter.key for parameter in algorithm.parameters if parameter.frictionless)


def knows_friction(algorithm: ContactAlgorithm) -> bool:
    """Whether it says so; a ``solve`` of a subclass's own is not what its parent has said that of."""
    order = type(algorithm).__mro__
    said, solves = ([i for i, each in enumerate(order) if name in vars(each)] for name in ("friction", "solve"))
    return bool(said and getattr(algorithm, "friction", False) and said[0] <= solves[0])


def unfit_with_friction(algorithm: ContactAlgorithm) -> str | None:
    """Why it takes no problem with friction, or what is set of it and means nothing there; None where it takes them."""
    if not knows_friction(algorithm):
        return f"{algorithm.name!r} does not support friction"
    usual, lost = type(algorithm)(), frictionless_parameters(algorithm)
    for key in lost:
        if getattr(algorithm, key) != getattr(usual, key):
            allowed = ", ".join(each.key for each in algorithm.parameters if each.key not in lost)
            return f"{key} = {getattr(algorithm, key)}: with friction {algorithm.name} has {allowed} only"
    return None


def require_friction(algorithm: ContactAlgorithm) -> None:
    """Raises ValueError unless the algorithm knows friction, and all that is set of it means something there."""
    unfit = unfit_with_friction(algorithm)
    if unfit:
        raise ValueError(unfit)


class ContractError(TypeError):
    """An algorithm has answered with what is not an answer; one line that names it."""


def unsupported(algorithm: ContactAlgorithm, problem: ContactProblem) -> str | None:
    """None where the algorithm supports the problem, or its reason. Raises ContractError for anything else."""
    said: object = algorithm.supports(problem)
    if said is None or (isinstance(said, str) and said):
        return said
    raise ContractError(f"contact algorithm {algorithm.name!r}: supports returned {said!r}, not None or a reason")


def answered(algorithm: ContactAlgorithm, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """What the algorithm answers; what it does not count is 0. Raises ContractError."""
    solution = algorithm.solve(problem, start)
    wrong = _wrong(solution, len(start.u), len(problem.weights))
    if wrong:
        raise ContractError(f"contact algorithm {algorithm.name!r}: solve returned {wrong}")
    if solution.counters.keys() >= {*COUNTERS}:
        return solution
    return replace(solution, counters={**dict.fromkeys(COUNTERS, 0), **solution.counters})


def _wrong(returned: object, n: int, m: int) -> str:
    """What is not an answer in n unknowns with m candidates; empty for an answer."""
    if not isinstance(returned, ContactSolution):
        return f"{_named(returned)}, not a ContactSolution"
    for name, kind, word, size in (
        ("u", "f", "floats", n),
        ("pressure", "f", "floats", m),
        ("active", "b", "booleans", m),
    ):
        given = getattr(returned, name)
        if not isinstance(given, np.ndarray) or given.dtype.kind != kind or given.shape != (size,):
            return f"{name} as {_named(given)}, not as {word} of shape ({size},)"
    if not isinstance(returned.outcome, Outcome):
        return f"outcome as {_named(returned.outcome)}, not as an Outcome"
    counts = returned.counters
    if not isinstance(counts, Mapping) or not all(
        isinstance(value, int | float | np.number) and 0 <= value < np.inf for value in counts.values()
    ):
        return "counters that are no finite numbers from 0 by name"
    rows = returned.history
    if not isinstance(rows, tuple) or not all(isinstance(row, Mapping) for row in rows):
        return "a history that is not a tuple of rows"
    if not all(isinstance(row["event"], Event) for row in rows if "event" in row):
        return "a history with an event that is no Event"
    return ""


def _named(value: object) -> str:
    if isinstance(value, np.ndarray):
        return f"{value.dtype} of shape {value.shape}"
    return "None" if value is None else type(value).__name__


def hasty(algorithm: ContactAlgorithm, most: int = FEW) -> ContactAlgorithm:
    """The algorithm that gives up after so many iterations and updates of the set, as far as it has such limits."""
    if not is_dataclass(algorithm):
        return algorithm
    known = {each.name for each in fields(algorithm)} & {"max_iterations", "max_updates"}
    return replace(algorithm, **dict.fromkeys(known, most))
