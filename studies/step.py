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
    """The load and the quantities at it {name_unit: value}, what the judge says of the state, and the counters."""

    load: Mapping[str, float]
    quantities: Mapping[str, Any]
    certificate: Mapping[str, Any]
    counters: Mapping[str, int]

    @classmethod
    def of(cls, entry: Mapping[str, Any], counters: Iterable[str] = ()) -> Step:
        """An entry of ``steps``, whose first key is the load; counters: the names that its result counts."""
        counted = {*counters, *OF_THE_PATH}
        seen = {key: value for key, value in entry.items() if key not in counted and key not in CERTIFICATE}
        return cls(
            load=dict(islice(seen.items(), 1)),
            quantities=dict(islice(seen.items(), 1, None)),
            certificate={key: entry[key] for key in CERTIFICATE if key in entry},
            counters={key: value for key, value in entry.items() if key in counted},
        )

    @property
    def seen(self) -> dict[str, Any]:
        """The load and the quantities."""
        return {**self.load, **self.quantities}

    @property
    def flat(self) -> dict[str, Any]:
        """The entry of ``steps``."""
        return {**self.seen, **self.certificate, **self.counters}


def unit_of(quantity: str) -> str:
    """What the name of a quantity ends in; where that is no unit, the name."""
    return next((unit for unit in UNITS if quantity.endswith(unit)), quantity)
