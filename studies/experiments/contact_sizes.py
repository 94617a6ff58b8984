"""What the contact algorithms cost over the number of unknowns: the tyre of the paper pressed to 20 mm.

Each is asked as it is, with its own default epsilon. The algorithms of one grid are solved in turns, round by round, so
that what else the machine does meets all alike; of several rounds the least processor time counts, which other programs
disturb least. Operations are the same in every round.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import pandas as pd

from contact.catalogue import ALGORITHMS
from studies.complete import complete
from studies.request import Request
from studies.result import Result
from studies.solving import solve

ROUNDS: Mapping[str, int] = {"20x18": 3, "28x26": 3, "42x40": 2, "60x56": 1, "84x80": 1}  # 2, 4, 10, 20, 40 thousand
SETTINGS = {"delta_mm": "20", "element": "paper"}
PRICES = ("seconds", "operations")
COLUMNS = (
    *("algorithm", "mesh", "unknowns", "outcome", "reason", "newton_iterations", "factorisations", "force_N"),
    *PRICES,
    *(f"{price}_over_default" for price in PRICES),
)


def contact_sizes(rounds: Mapping[str, int] = ROUNDS, algorithms: Sequence[str] = ()) -> pd.DataFrame:
    """One row a grid and algorithm: COLUMNS, prices NaN where it is not solved.

    over_default: the price over that of the default algorithm on the same grid.  rounds: by the mesh.
    """
    tables = [_on_grid(mesh, count, algorithms or tuple(ALGORITHMS)) for mesh, count in rounds.items()]
    return pd.concat(tables, ignore_index=True)


def _on_grid(mesh: str, rounds: int, algorithms: Sequence[str]) -> pd.DataFrame:
    found = [[_solved(mesh, algorithm) for algorithm in algorithms] for _ in range(rounds)]
    rows = []
    for name, *again in zip(algorithms, *found, strict=True):
        result = again[0]
        told = {"algorithm": name, "mesh": mesh, "unknowns": result.counters["dofs"]}
        told |= {"outcome": result.verdict, "reason": result.reason or result.unsupported}
        counted = {key: result.counters[key] for key in ("newton_iterations", "factorisations")}
        if result.outcome.converged:
            counted |= {"force_N": result.quantities["force_N"], "operations": result.counters["operations"]}
            counted |= {"seconds": min(each.timing["cpu"] for each in again)}
        rows.append({**told, **counted})
    table = pd.DataFrame(rows).reindex(columns=list(COLUMNS))
    default = table[table["algorithm"] == Request.contact]
    for price in PRICES if len(default) else ():
        table[f"{price}_over_default"] = table[price] / default[price].iloc[0]
    return table


def _solved(mesh: str, algorithm: str) -> Result:
    return solve(*complete("tyre", SETTINGS, mesh, contact=algorithm, model="full"))
