"""What the rim of contact leaves unknown: forces that are handed on, and values that agree on three grids by luck."""

from __future__ import annotations

import numpy as np
import pytest

from studies.scenes.complete import complete
from studies.scenes.contact.base import ContactModel
from studies.solving.refinement.mesh_error import solve_with_error
from studies.solving.refinement.nested import sketch
from studies.solving.refinement.rim import LAYER, LEAST, _shorter, rims_of
from studies.solving.solve import solve


def test_a_patch_one_element_shorter_has_the_same_force() -> None:
    path = sketch(*complete("strip-contact", {"lam_over_a": "0.5", "load_fraction": "37"}, "16x1"))
    assert path is not None
    assert isinstance(path.model, ContactModel)
    problem, state = path.end.problem, path.end.point.solution
    shorter = _shorter(path.model, problem, state)
    assert shorter is not None
    whole, moved = (problem.nodal_forces(each.pressure) for each in (state, shorter))
    x = path.model.shell.discretisation.grid.nodes[path.model.nodes, 0]
    assert moved.sum() == pytest.approx(whole.sum(), rel=1e-12)
    assert x[moved > 0].min() - x[whole > 0].min() == pytest.approx(100 / 16)
    assert np.array_equal(shorter.active, moved > 0)
    (left,) = rims_of(path, [path.quantities])
    least = LEAST / 16**2
    assert left["half_force"] == pytest.approx(least * path.quantities["half_force"])
    assert left["edge_pressure"] >= least * path.quantities["edge_pressure"]
    (finer,), (finest,) = (rims_of(path, [path.quantities], each) for each in (0.5, 1e-3))
    assert finest["edge_pressure"] == pytest.approx(LEAST * (LAYER / 100) ** 2 * path.quantities["edge_pressure"])
    assert finer["half_force"] == pytest.approx(left["half_force"] / 4)


def test_what_touches_nothing_has_no_rim() -> None:
    path = sketch(*complete("strip-contact", {"load_fraction": "0.5"}, "16x1"))
    assert path is not None
    assert rims_of(path, [path.quantities]) == [{}]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "settings", "quantity"),
    [
        ("plate-contact", {"hole": "0.1", "load_fraction": "60"}, "contact_radius"),
        ("strip-contact", {"lam_over_a": "0.8", "load_fraction": "47"}, "edge_pressure"),
        ("strip-contact", {"lam_over_a": "0.3", "load_fraction": "30"}, "edge_pressure"),
        ("strip-contact", {"lam_over_a": "0.03", "load_fraction": "29"}, "half_force"),
    ],
)
def test_grids_that_agree_by_luck_state_no_narrow_limit(scene: str, settings: dict[str, str], quantity: str) -> None:
    """Of a grid with four times the elements: on three grids up to 64 elements these values differ by far less."""
    asked = complete(scene, settings, "64x1")
    truth = solve(*complete(scene, settings, "256x1")).quantities[quantity]
    interval = solve_with_error(*asked).errors[quantity]
    assert interval["low"] < truth < interval["high"]
