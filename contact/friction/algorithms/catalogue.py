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


def twin(algorithm: ContactAlgorithm) -> FrictionalAlgorithm:
    """The algorithm of the same name with friction, from the fields that both have; raises ValueError where none is.

    What only the frictionless one has is left out: semismooth's c, the condensed or full system of qp and lcp, the
    method of lcp, which is Lemke's here.
    """
    if algorithm.name not in FRICTIONAL:
        raise ValueError(f"{algorithm.name!r} has no twin with friction; there are {', '.join(FRICTIONAL)}")
    kind = FRICTIONAL[algorithm.name]
    fields = vars(kind())
    return kind(**{name: value for name, value in vars(algorithm).items() if name in fields})
