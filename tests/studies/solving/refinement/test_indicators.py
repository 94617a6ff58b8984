"""Indicators against closed forms, and what they are made of against the change of a quantity from grid to grid."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formulations.geometry.quadtree import Quadtree
from formulations.geometry.surfaces import Plate
from formulations.section.laminate import Laminate, Ply
from studies.scenes.complete import complete
from studies.solving.refinement.adaptive_grids import Family, dorfler
from studies.solving.refinement.goal import OnGrid, indicators, on_grid
from studies.solving.solve import solve
from support.problems.shells import make_shell

E, H = 1000.0, 0.1  # MPa, mm


def plates(n: int) -> tuple[OnGrid, OnGrid, np.ndarray]:
    """A free square plate of side 1 at rest, n x n elements and 2n x 2n, and the parents."""
    tree = Quadtree.over(*(np.linspace(0, 1, n + 1),) * 2)
    finer, actual = tree.everywhere(), []
    for each in (tree, finer):
        shell = make_shell(Plate(), each.grid(), Laminate.single(Ply.isotropic(E, 0.0, H)), measure="linear")
        none = np.zeros(shell.discretisation.n_free)
        actual.append(OnGrid(shell, none, none, np.zeros((4, shell.discretisation.grid.n_nodes))))
    return actual[0], actual[1], tree.parents(finer)


def stretched(at: OnGrid) -> OnGrid:
    """u1 = s^2 + s y of both faces, s = max(x - 1/2, 0), and three times as much for the dual displacements."""
    discretisation = at.shell.discretisation
    full = np.zeros((discretisation.grid.n_nodes, 6))
    x, y = discretisation.grid.nodes.T
    s = np.maximum(x - 0.5, 0)
    full[:, :2] = (s**2 + s * y)[:, None]
    u = discretisation.map.restrict(full)
    return replace(at, u=u, z=3 * u)


def test_a_stretched_plate_has_the_indicators_of_its_closed_form() -> None:
    """In each part of an element of side a beyond x = 1/2, E11 is a/2 off and 2 E12 is a/4; nu = 0, G = E/2."""
    coarse, fine, parents = plates(4)
    eta, rim = indicators(stretched(coarse), stretched(fine), parents)
    right, a = coarse.shell.discretisation.grid.centre[:, 0] > 0.5, 0.25
    exact = 3 * H * a**2 * (E * (a / 2) ** 2 + E / 2 * (a / 4) ** 2)
    np.testing.assert_allclose(eta, np.where(right, exact, 0), rtol=1e-9, atol=1e-14)
    assert rim == 0


def test_pressures_meet_the_gaps_of_the_other_grid() -> None:
    """Pressure, gap and their duals, each alike everywhere: area (p_z (g - g') + p (g_z' - g_z))."""
    coarse, fine, parents = plates(2)
    here, there = (np.array(each)[:, None] for each in ((2.0, 0.2, 9.0, 0.1), (7.0, 0.15, 0.5, 0.3)))
    with_contact = [replace(at, contact=at.contact + each) for at, each in ((coarse, here), (fine, there))]
    eta, rim = indicators(*with_contact, parents)
    assert rim == pytest.approx(0.5 * 0.05 + 2.0 * 0.2)
    np.testing.assert_allclose(eta, rim / 4)


def test_indicators_fall_with_the_square_of_the_elements() -> None:
    scene, request = complete("pagano", {"S": "10"}, (4, 4))
    family, sums = Family.of(scene, request), []
    families = [family, family.everywhere(), family.everywhere().everywhere()]
    states = [on_grid(solve(scene, each.asked), "w_bar") for each in families]
    for (one, other), (coarse, fine) in zip(pairwise(families), pairwise(states), strict=True):
        sums.append(indicators(coarse, fine, one.tree.parents(other.tree))[0].sum())
    assert sums[0] / sums[1] == pytest.approx(4, rel=0.1)


@given(st.lists(st.integers(0, 20), min_size=1, max_size=7).filter(any), st.sampled_from([0.25, 0.5, 0.75]))
def test_no_fewer_elements_have_the_share(values: list[int], share: float) -> None:
    eta = np.array(values, float)
    marked = dorfler(eta, share)
    assert eta[marked].sum() >= share * eta.sum()
    fewer = combinations(values, int(marked.sum()) - 1)
    assert all(sum(chosen) < share * eta.sum() for chosen in fewer)
