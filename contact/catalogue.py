"""The catalogue of contact algorithms: a new one is one file and one line here. Each is loaded when it is asked for.

What an algorithm does must never enter here.
"""

import importlib
from collections.abc import Callable, Iterator, Mapping, MutableMapping
from types import ModuleType
from typing import TypeVar

import numpy as np

from contact.problem import ContactAlgorithm

T = TypeVar("T")
CLASSES: Mapping[str, tuple[str, str]] = {  # module and class of the algorithm of a name
    "trial-and-error": ("contact.algorithms.trial_and_error", "TrialAndError"),
    "semismooth": ("contact.algorithms.semismooth", "Semismooth"),
    "regularised": ("contact.algorithms.regularised", "Regularised"),
    "augmented-lagrangian": ("contact.algorithms.augmented_lagrangian", "AugmentedLagrangian"),
    "qp": ("contact.algorithms.qp", "Qp"),
    "lcp": ("contact.algorithms.lcp", "Lcp"),
}


class Catalogue(MutableMapping[str, T]):
    """Parts by name, ours and those that are put in; names are known without loading anything."""

    def __init__(self, modules: Mapping[str, str], part_of: Callable[[ModuleType, str], T]) -> None:
        """modules: of our parts by name.  part_of: a part of a loaded module by its name."""
        self._modules, self._part_of = modules, part_of
        self._parts: dict[str, T | None] = dict.fromkeys(modules)  # None: not loaded yet

    def __getitem__(self, name: str) -> T:
        part = self._parts[name]
        if part is None:
            part = self._parts[name] = self._part_of(importlib.import_module(self._modules[name]), name)
        return part

    def __setitem__(self, name: str, part: T) -> None:
        self._parts[name] = part

    def __delitem__(self, name: str) -> None:
        del self._parts[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._parts)

    def __len__(self) -> int:
        return len(self._parts)

    def __contains__(self, name: object) -> bool:
        return name in self._parts


def _class_of(module: ModuleType, name: str) -> type[ContactAlgorithm]:
    algorithm: type[ContactAlgorithm] = getattr(module, CLASSES[name][1])
    return algorithm


ALGORITHMS: Catalogue[type[ContactAlgorithm]] = Catalogue(
    {name: module for name, (module, _) in CLASSES.items()}, _class_of
)


def is_exact(name: str) -> bool:
    """Whether an algorithm can enforce the constraint itself: springs alone cannot."""
    return not getattr(ALGORITHMS[name], "springs", False)


def by_the_exact_law(springs: float = 1e4, *, naive: bool = False) -> dict[str, ContactAlgorithm]:
    """All of the catalogue with an infinite epsilon, and those that have none, on ``springs`` [MPa/mm].

    naive: whether trial-and-error leaves cycles with friction unanswered.
    """
    algorithms = {name: kind(epsilon=np.inf if is_exact(name) else springs) for name, kind in ALGORITHMS.items()}
    return algorithms | {"trial-and-error": ALGORITHMS["trial-and-error"](epsilon=np.inf, naive=naive)}
