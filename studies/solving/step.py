"""One requested load of a path: what was read off there, how it was judged and what it cost; flat in result.json."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import islice
from typing import Any

CERTIFICATE = ("failures", "exceeded", "kkt", "balances", "rounding", "scales", "diagnosis", "stability")
UNITS = ("_N_mm", "_N", "_MPa", "_mm")  # that a quantity may end in
# which no smaller step or element changes by a smaller amount
COUNTS = ("contact_nodes", "sticking", "slipping", "limit_points")
OF_THE_PATH = ("substeps", "limit_point")  # counted beside what the algorithm counts


@dataclass(frozen=True, eq=False)
class Step:
    """seen: the load, which comes first, and the quantities at it {name_unit: value}; certificate: what the judge says
    of the state; counters: what it has cost.
    """

    seen: dict[str, Any]
    certificate: Mapping[str, Any]
    counters: Mapping[str, int]

    @property
    def load(self) -> dict[str, float]:
        """The load alone."""
        return dict(islice(self.seen.items(), 1))

    @property
    def quantities(self) -> dict[str, Any]:
        """All that was read off beside it."""
        return dict(islice(self.seen.items(), 1, None))

    @property
    def flat(self) -> dict[str, Any]:
        """The entry of ``steps`` in result.json."""
        judged = {key: self.certificate[key] for key in CERTIFICATE if key in self.certificate}
        return {**self.seen, **judged, **self.counters}


def seen_in(entry: Mapping[str, Any], counters: Iterable[str]) -> dict[str, Any]:
    """Load and quantities of an entry of ``steps``; counters: the names that its result counts."""
    others = {*counters, *OF_THE_PATH, *CERTIFICATE}
    return {key: value for key, value in entry.items() if key not in others}


def unit_of(quantity: str) -> str:
    """What the name of a quantity ends in; where that is no unit, the name."""
    return next((unit for unit in UNITS if quantity.endswith(unit)), quantity)
