"""Whether stated errors are honest: quantities of all scenes to several errors, against limits of other grids.

The limit that counts for true is that of uniform grids, each with twice the elements of the one before both ways, far
beyond where a statement ends: Richardson's for the order 2 of the finest two, uncertain by what it differs from that of
the two before. A case whose true limit is not known to a third of what is stated, or comes from no finer grid, decides
nothing and counts apart.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from itertools import pairwise

import pandas as pd

from studies.analysis.richardson import correction
from studies.refinement.error_control import FEWEST, coarsest, solve_to_error
from studies.refinement.rounds import Round, estimate
from studies.solving import solve

ERRORS = (0.05, 0.01, 0.002)
FINEST = 40_000  # unknowns of the grids that count for true, and of a run; a tenth where one element stands across
ROUND = [each.name for each in fields(Round)]
KNOWN = 1 / 3  # of the stated uncertainty, to which the true limit must be known


@dataclass(frozen=True)
class Case:
    """Quantities of a scene."""

    scene: str
    quantities: Sequence[str]
    settings: Mapping[str, str] = field(default_factory=dict)


CASES = (
    Case("cantilever", ("tip_deflection_mm", "tip_shortening_mm")),
    Case("hemisphere", ("inward_mm", "outward_mm"), {"load_fraction": "0.25"}),
    Case("hemisphere", ("inward_mm", "outward_mm"), {"load_fraction": "0.25", "interpolation": "isoparametric"}),
    Case("sze-annulus", ("w_A_mm", "w_B_mm"), {"load_fraction": "0.1"}),
    Case("sze-moment", ("tip_deflection_mm", "tip_shortening_mm"), {"load_fraction": "0.5"}),
    Case("sze-pullout", ("w_A_even_mm", "u_B_mm"), {"load_fraction": "0.025"}),
    Case("sze-pinched", ("w_A_mm",), {"load_fraction": "0.05"}),
    Case("semicylinder", ("w_A_mm",), {"load_fraction": "0.25"}),
    Case("semicylinder-0-90-0", ("w_A_mm",), {"load_fraction": "0.25"}),
    Case("semicylinder-90-0-90", ("w_A_mm",), {"load_fraction": "0.25"}),
    Case("roof-a", ("limit_load_fraction", "limit_w_C_even_mm"), {"until": "limit"}),
    Case("roof-b", ("limit_load_fraction",), {"until": "limit"}),
    Case("roof-c", ("limit_load_fraction",), {"until": "limit"}),
    Case("roof-d", ("limit_load_fraction",), {"until": "limit"}),
    Case("roof-e", ("limit_load_fraction",), {"until": "limit"}),
    Case("roof-f", ("limit_load_fraction",), {"until": "limit"}),
    Case("shallow-cap", ("limit_load_fraction", "limit_w_apex_mm")),
    Case("pressurised-cylinder", ("stretch", "thickness_ratio")),
    Case("pressurised-sphere", ("stretch",)),
    Case("pressurised-torus", ("N_phi_crown_N_per_mm", "N_theta_outer_N_per_mm", "N_theta_inner_N_per_mm")),
    Case("scordelis-lo", ("edge_deflection_mm",)),
    Case("scordelis-lo", ("edge_deflection_mm",), {"interpolation": "isoparametric"}),
    Case("pinched-cylinder", ("deflection_mm",)),
    Case("pagano", ("w_bar", "sigma_x_bar", "tau_xz_bar"), {"S": "10"}),
    Case("pagano", ("w_bar", "sigma_x_bar"), {"S": "100"}),
    Case("strip-contact", ("half_force", "free_length", "edge_pressure")),
    Case("heavy-strip", ("lift_force", "free_length")),
    Case("plate-contact", ("contact_force", "contact_radius")),
    Case("ring", ("P_R2_over_EI", "P_H2_over_EI"), {"delta_mm": "35"}),
    Case("tyre", ("force_N", "centre_pressure_MPa", "half_length_mm"), {"delta_mm": "10"}),
    Case("tyre", ("force_N",), {"delta_mm": "20"}),
    Case("tyre", ("force_N",), {"delta_mm": "20", "element": "paper"}),
    Case("tyre", ("force_N",), {"delta_mm": "10", "E_MPa": "20", "nu": "0.45"}),
)


@dataclass(frozen=True)
class Truth:
    """The limit of uniform grids, what it is known to a part of, and the unknowns of the finest of them."""

    limit: float
    known: float
    unknowns: int


def error_coverage(
    cases: Iterable[Case] = CASES, errors: Sequence[float] = ERRORS, finest: float = FINEST
) -> pd.DataFrame:
    """One row a case, quantity and error: what is stated, what counts for true, and what both cost.

    low, high: what is stated of the relative error of the value on the last grid; value_error: that error, against
    the limit ``true`` of other grids, ``known`` to a part of it.  stated, uncertainty: the limit and what is stated of
    it; off: how far the two limits are apart.  value_inside, inside: whether they are as stated; value_decided,
    decided: whether the true limit is known well enough to say so, or they are not, whatever it is.  cost: CPU time
    over that of the last grid alone.
    """
    rows: list[dict[str, object]] = []
    for case in cases:
        truths = uniform_limits(case, finest)
        for quantity in case.quantities:
            rows.extend(_statements(case, quantity, errors, truths.get(quantity), finest))
    return pd.DataFrame(rows)


def uniform_limits(case: Case, finest: float = FINEST) -> dict[str, Truth]:
    """What uniform grids say of each quantity."""
    scene, request = coarsest(case.scene, case.settings)
    most = finest if min(request.mesh) > 1 else finest / 10
    values: dict[str, list[float]] = {quantity: [] for quantity in case.quantities}
    for times in range(10):
        n1, n2 = (n * 2**times if n > 1 else 1 for n in request.mesh)
        result = solve(scene, replace(request, mesh=(n1, n2)))
        if result.outcome.converged:
            for quantity, seen in values.items():
                seen.append(result.quantities[quantity])
        if 4 * result.counters["dofs"] > most:
            break
    found = {}
    for quantity, seen in values.items():
        if len(seen) > 2:
            before, limit = (pair[1] + correction((2.0, 1.0), pair) for pair in pairwise(seen[-3:]))
            found[quantity] = Truth(limit, abs(limit - before) / abs(limit), int(result.counters["dofs"]))
    return found


def _statements(
    case: Case, quantity: str, errors: Sequence[float], truth: Truth | None, most: float
) -> Iterator[dict[str, object]]:
    """One run to the least error: a larger one is stated where its rounds reach it."""
    result, _ = solve_to_error(*coarsest(case.scene, case.settings), min(errors), quantity, most=int(most))
    rows = result.table("refinement").rows() if "refinement" in result.tables else ()
    rounds = [Round(*(row[name] for name in ROUND)) for row in rows]
    for error in errors:
        ends = (n for n in range(FEWEST, len(rounds) + 1) if estimate(rounds[:n]).uncertainty <= error)
        n = next(ends, None)
        row: dict[str, object] = {
            "scene": case.scene,
            "settings": " ".join(f"{key}={value}" for key, value in case.settings.items()),
            "quantity": quantity,
            "asked": error,
            "reached": n is not None,
            "reason": "" if n is not None else result.reason,
        }
        yield row | _against(rounds[:n], truth) if rounds else row


def _against(rounds: Sequence[Round], truth: Truth | None) -> dict[str, object]:
    """What rounds state, beside the truth where there is one."""
    last, stated = rounds[-1], estimate(rounds)
    found: dict[str, object] = {
        "stated": stated.limit,
        "uncertainty": stated.uncertainty,
        "low": stated.low,
        "high": stated.high,
        "unknowns": last.finer_unknowns,
        "cost": sum(each.seconds for each in rounds) / last.finer_seconds,
    }
    if truth is None:
        return found
    known, coarser = truth.known, last.finer_unknowns < truth.unknowns
    off, error = abs(stated.limit / truth.limit - 1), abs(last.finer / truth.limit - 1)
    inside = off <= stated.uncertainty + known
    value_inside = stated.low - known <= error <= stated.high + known
    return found | {
        "true": truth.limit,
        "known": known,
        "value_error": error,
        "value_decided": coarser and (known <= KNOWN * (stated.high - stated.low) or not value_inside),
        "value_inside": value_inside,
        "off": off,
        "decided": coarser and (known <= KNOWN * stated.uncertainty or not inside),
        "inside": inside,
    }
