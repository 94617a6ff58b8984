"""The dual problem of a quantity: its displacements and pressures against what small forces and gaps really change."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contact.problem import Linearisation, Linearise
from studies.ask.settings import configured
from studies.scenes.complete import complete
from studies.scenes.curves import ArcStage
from studies.solving.refinement.goal import dual, gradient, on_grid
from studies.solving.result import Result
from studies.solving.solve import solve

SMALL = 1e-5  # of the forces in balance, by which the load is changed
NARROW = 1e-8  # mm, by which gaps are changed: no node may leave the contact set or join it
SAME = 1e-5  # of the change: J' by differences, and what is not linear in a small one
CASES = [  # the last one has a tangent that is not symmetric
    ("scordelis-lo", "4x4", {}, "edge_deflection_mm"),
    ("strip-contact", "16x1", {"load_fraction": "5"}, "half_force"),
    ("strip-contact", "16x1", {"load_fraction": "5"}, "edge_pressure"),
    ("plate-contact", "8x1", {}, "contact_force"),
    ("tyre", "8x8", {"section": "nonsymmetric", "element": "paper", "delta_mm": "4"}, "force_N"),
]


def solved(scene: str, mesh: str, settings: dict[str, str]) -> Result:
    return solve(*complete(scene, settings, mesh))


def under(linearise: Linearise, force: np.ndarray) -> Linearise:
    """With a dead force (n,) more."""

    def more(u: np.ndarray, memory: object) -> Linearisation:
        lin = linearise(u, memory)
        return Linearisation(lin.residual - force, lin.tangent, lin.scale, lin.remember)

    return more


@pytest.mark.parametrize(("scene", "mesh", "settings", "quantity"), CASES)
def test_small_forces_and_gaps_change_the_quantity_as_its_dual_says(scene, mesh, settings, quantity) -> None:
    result = solved(scene, mesh, settings)
    visited, algorithm = result.end, configured(result.request.contact, result.request.settings)
    problem, state = visited.problem, visited.point.solution
    z, dual_pressure = dual(visited, quantity)
    rng = np.random.default_rng(0)
    force, opened = rng.standard_normal(len(z)), rng.standard_normal(len(dual_pressure))
    force *= SMALL * problem.linearise(state.u, None).scale / np.linalg.norm(force)

    def change(force: np.ndarray, opened: np.ndarray) -> float:
        values = []
        for sign in (1, -1):
            fields = {"linearise": under(problem.linearise, sign * force), "only": None}
            moved = replace(problem, gap=lambda u, sign=sign: problem.gap(u) + sign * opened, **fields)
            there = algorithm.solve(moved, state)
            assert there.outcome.converged
            np.testing.assert_array_equal(there.active, state.active)
            values.append(visited.stage.observe(problem, there, visited.point.requested).quantities[quantity])
        return 0.5 * (values[0] - values[1])

    assert change(force, 0 * opened) == pytest.approx(z @ force, rel=SAME)
    if len(opened):
        assert state.active.any()
        expected = NARROW * float(dual_pressure @ (problem.weights * opened))
        assert change(0 * force, NARROW * opened) == pytest.approx(expected, rel=SAME)


def test_a_small_force_moves_the_limit_load_as_the_mode_says() -> None:
    result = solved("roof-a", "4x4", {"until": "limit", "path": "arc-length", "arc_step": "0.05"})
    stage = result.end.stage
    assert isinstance(stage, ArcStage)
    actual = on_grid(result, "limit_load_fraction")
    force = np.random.default_rng(0).random(len(actual.z))
    force *= 1e-3 * np.linalg.norm(stage.load) / np.linalg.norm(force)

    def limit(more: np.ndarray) -> float:
        trace = stage.continuation.trace(under(stage.linearise, more), stage.load, stage.targets)
        return next(point.factor for point in trace.points if point.limit)

    assert 0.5 * (limit(force) - limit(-force)) == pytest.approx(actual.z @ force, rel=SAME)


def test_without_a_limit_point_there_is_no_dual_of_its_load() -> None:
    result = solved("roof-a", "4x4", {"load_fraction": "0.1"})
    with pytest.raises(KeyError, match="no limit point"):
        on_grid(result, "limit_load_fraction")


def test_contact_is_at_its_nodes_of_the_grid() -> None:
    result = solved("strip-contact", "16x1", {"load_fraction": "5"})
    model, state, problem = result.model, result.end.point.solution, result.end.problem
    actual = on_grid(result, "half_force")
    np.testing.assert_array_equal(actual.contact[0], model.outer_pressure(state))
    along = actual.z / np.max(np.abs(actual.z))  # mm; the gap before a plane is linear
    turned = (problem.gap(state.u + along) - problem.gap(state.u)) * np.max(np.abs(actual.z))
    np.testing.assert_allclose(actual.contact[3][model.nodes], turned, atol=1e-12 * np.max(np.abs(turned)))
    assert np.all(actual.contact[:, model.held] == 0)
    assert np.any(actual.contact[2] != 0)


def test_the_gradient_finds_the_few_unknowns_that_count() -> None:
    """Of two sizes, and two of them with slopes that cancel when all move alike."""
    seen = []

    def function(x: np.ndarray) -> float:
        seen.append(x)
        return float(x[3] ** 2 + 5 * x[40] - 5 * x[41] + 2e6 * x[150])

    x = np.append(np.linspace(1, 2, 100), np.linspace(1e-6, 2e-6, 100))
    slope = np.zeros(200)
    slope[[3, 40, 41, 150]] = 2 * x[3], 5, -5, 2e6
    np.testing.assert_allclose(gradient(function, x, (np.arange(100), np.arange(100, 200))), slope, rtol=1e-5)
    assert len(seen) < 100
