"""The catalogue of contact algorithms; a new one is one file and one line here."""

from __future__ import annotations

from collections.abc import Callable

from contact.algorithms.augmented_lagrangian import AugmentedLagrangian
from contact.algorithms.lcp import Lcp
from contact.algorithms.qp import Qp
from contact.algorithms.regularised import Regularised
from contact.algorithms.semismooth import Semismooth
from contact.algorithms.trial_and_error import TrialAndError
from contact.problem import ContactAlgorithm

ALGORITHMS: dict[str, Callable[..., ContactAlgorithm]] = {
    "trial-and-error": TrialAndError,
    "semismooth": Semismooth,
    "regularised": Regularised,
    "augmented-lagrangian": AugmentedLagrangian,
    "qp": Qp,
    "lcp": Lcp,
}
