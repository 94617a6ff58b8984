"""The catalogue of contact algorithms; a new one is one file and one line here."""

from __future__ import annotations

from collections.abc import Callable

from contact.augmented_lagrangian import AugmentedLagrangian
from contact.lcp import Lcp
from contact.problem import ContactAlgorithm
from contact.qp import Qp
from contact.regularised import Regularised
from contact.semismooth import Semismooth
from contact.trial_and_error import TrialAndError

ALGORITHMS: dict[str, Callable[..., ContactAlgorithm]] = {
    "trial-and-error": TrialAndError,
    "semismooth": Semismooth,
    "regularised": Regularised,
    "augmented-lagrangian": AugmentedLagrangian,
    "qp": Qp,
    "lcp": Lcp,
}
