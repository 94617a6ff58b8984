"""Whether stated errors are honest: quantities of all scenes to several errors, against limits of other grids.

The limit that counts for true is that of uniform grids, each with twice the elements of the one before both ways, far
beyond where a statement ends: Richardson's for the order 2 of the finest two, uncertain by what it differs from that of
the two before. A case whose true limit is not known to a third of what is stated decides nothing and is told apart.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import pandas as pd

from studies.complete import complete
from studies.error_control import coarsest_mesh, solve_to_error
from studies.request import Request
from studies.scene import Scene
from studies.scenes import SCENES
from studies.solving import solve

ERRORS = (0.05, 0.01)
FINEST = 30_000  # unknowns of the grids that count for true; a tenth of it where one element stands across
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
    Case("roof-a", ("limit_load_fraction", "limit_w_C_even_mm"), {"until": "limit"}),
    Case("roof-b", ("limit_load_fraction",), {"until": "limit"}),
    Case("roof-c", ("limit_load_fraction",), {"until": "limit"}),
    Case("roof-d", ("limit_load_fraction",), {"until": "limit"}),
    Case("roof-e", ("limit_load_fraction",), {"until": "limit"}),
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


def error_coverage(
    cases: Iterable[Case] = CASES, errors: Sequence[float] = ERRORS, finest: float = FINEST
) -> pd.DataFrame:
    """One row a case, quantity and error: what is stated, what counts for true, and what both cost.

    stated, uncertainty: the limit and its relative uncertainty; true, known: the other limit and its own.  inside:
    whether they differ by no more than is stated; decided: whether the true one is known well enough to say so.
    value_error: of the value on the last grid, low and high what is stated of it.  cost: CPU time over that of the last
    grid alone.
    """
    rows = []
    for case in cases:
        truths = uniform_limits(case, finest)
        for quantity in case.quantities:
            for error in errors:
                rows.append(_stated(case, quantity, error, truths.get(quantity)))
    return pd.DataFrame(rows)


def uniform_limits(case: Case, finest: float = FINEST) -> dict[str, tuple[float, float]]:
    """Limit and relative uncertainty of each quantity on uniform grids."""
    scene, request = _asked(case)
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
            before, limit = (fine + (fine - coarse) / 3 for coarse, fine in zip(seen[-3:-1], seen[-2:], strict=True))
            found[quantity] = limit, abs(limit - before) / abs(limit)
    return found


def _asked(case: Case) -> tuple[Scene, Request]:
    scene = SCENES[case.scene]
    grading = {"grading": "uniform"} if case.scene == "tyre" else {}
    return complete(case.scene, {**grading, **case.settings}, coarsest_mesh(scene))


def _stated(case: Case, quantity: str, error: float, truth: tuple[float, float] | None) -> dict[str, object]:
    row: dict[str, object] = {
        "scene": case.scene,
        "settings": " ".join(f"{key}={value}" for key, value in case.settings.items()),
        "quantity": quantity,
        "asked": error,
    }
    scene, request = _asked(case)
    result, enough = solve_to_error(scene, request, error, quantity)
    row |= {"reached": enough, "reason": result.reason}
    if "uncertainty" not in result.quantities or truth is None:
        return row | {"decided": False}
    seen, (true, known) = result.quantities, truth
    stated, uncertainty = seen[f"extrapolated_{quantity}"], seen["uncertainty"]
    value_error = abs(seen[quantity] / true - 1)
    rounds = result.tables["refinement"][0]
    return row | {
        "stated": stated,
        "uncertainty": uncertainty,
        "true": true,
        "known": known,
        "decided": known <= KNOWN * uncertainty,
        "inside": abs(stated - true) <= uncertainty * abs(stated) + known * abs(true),
        "value_error": value_error,
        "low": seen["error_low"],
        "high": seen["error_high"],
        "unknowns": int(rounds["finer_unknowns"].iloc[-1]),
        "cost": float(rounds["seconds"].sum() / result.timing["cpu"]),
    }
