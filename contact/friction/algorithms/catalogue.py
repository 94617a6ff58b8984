"""The catalogue of algorithms with friction, by the names of their frictionless twins."""

from __future__ import annotations

from contact.friction.algorithms.augmented_lagrangian import AugmentedLagrangian
from contact.friction.algorithms.base import FrictionalAlgorithm
from contact.friction.algorithms.lcp import Lcp
from contact.friction.algorithms.qp import Qp
from contact.friction.algorithms.regularised import Regularised
from contact.friction.algorithms.semismooth import Semismooth
from contact.friction.algorithms.trial_and_error import TrialAndError
from contact.problem import ContactAlgorithm

FRICTIONAL: dict[str, type[FrictionalAlgorithm]] = {
    algorithm.name: algorithm for algorithm in (TrialAndError, Semismooth, Regularised, AugmentedLagrangian, Qp, Lcp)
}


def left_out(algorithm: ContactAlgorithm | type[ContactAlgorithm]) -> tuple[str, ...]:
    """Parameters of an algorithm that the one of the same name with friction does not have; none where there is none.

    They are semismooth's c, the condensed or full system of qp and lcp, and the method of lcp: with friction Lemke's.
    """
    kind = FRICTIONAL.get(algorithm.name)
    fields = {} if kind is None else vars(kind())
    return tuple(parameter.key for parameter in algorithm.parameters if kind and parameter.key not in fields)


def twin(algorithm: ContactAlgorithm) -> FrictionalAlgorithm:
    """The algorithm of the same name with friction, from the fields that both have.

    Raises ValueError where there is none, and for a value of a parameter that it does not have, unless the default.
    """
    if algorithm.name not in FRICTIONAL:
        raise ValueError(f"{algorithm.name!r} has no twin with friction; there are {', '.join(FRICTIONAL)}")
    usual, lost = type(algorithm)(), left_out(algorithm)
    for key in lost:
        if getattr(algorithm, key) != getattr(usual, key):
            allowed = ", ".join(each.key for each in algorithm.parameters if each.key not in lost)
            raise ValueError(f"{key} = {getattr(algorithm, key)}: with friction {algorithm.name} has {allowed} only")
    kind = FRICTIONAL[algorithm.name]
    fields = vars(kind())
    return kind(**{name: value for name, value in vars(algorithm).items() if name in fields})
