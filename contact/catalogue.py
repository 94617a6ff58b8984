"""The catalogue of contact algorithms; a new one is one file and one line here."""

import numpy as np

from contact.algorithms.augmented_lagrangian import AugmentedLagrangian
from contact.algorithms.lcp import Lcp
from contact.algorithms.qp import Qp
from contact.algorithms.regularised import Regularised
from contact.algorithms.semismooth import Semismooth
from contact.algorithms.trial_and_error import TrialAndError
from contact.problem import ContactAlgorithm

ALGORITHMS: dict[str, type[ContactAlgorithm]] = {
    algorithm.name: algorithm for algorithm in (TrialAndError, Semismooth, Regularised, AugmentedLagrangian, Qp, Lcp)
}


def is_exact(name: str) -> bool:
    """Whether an algorithm can enforce the constraint itself: springs alone cannot."""
    return not getattr(ALGORITHMS[name], "springs", False)


def by_the_exact_law(springs: float = 1e4, *, naive: bool = False) -> dict[str, ContactAlgorithm]:
    """All of the catalogue with an infinite epsilon, and those that have none, on ``springs`` [MPa/mm].

    naive: whether trial-and-error leaves cycles with friction unanswered.
    """
    algorithms = {name: kind(epsilon=np.inf if is_exact(name) else springs) for name, kind in ALGORITHMS.items()}
    return algorithms | {TrialAndError.name: TrialAndError(epsilon=np.inf, naive=naive)}
