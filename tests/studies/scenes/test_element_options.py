"""Element options as settings of the scenes, and loads on an element whose positions are interpolated."""

from __future__ import annotations

import numpy as np
import pytest

from formulations.discretisation import Discretisation
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import cylinder
from formulations.loads.pressure import Pressure
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.catalogue import EXACT
from studies.scenes.benchmarks.sze_moment import H, L
from studies.scenes.complete import complete as resolve
from studies.scenes.statics import area_load
from studies.solving.solve import solve


@pytest.mark.slow
def test_balanced_thickness_strain_rolls_a_strip_with_the_order_four() -> None:
    """The moment of an element is off by (c/2 - 1/6) phi^3, and c = 1/3: found on the roll-up of Sze 3.3.

    The limit is that of the strip as this shell sees it, with the curvature 1 + 5/6 (h kappa)^2 times the inextensible.
    """
    found = {}
    for option in ("projected", "balanced", "nodal"):
        found[option] = [
            solve(
                *resolve("sze-moment", {"thickness_strain": option, "load_fraction": "1"}, f"{n}x1", steps=4)
            ).quantities["tip_shortening_mm"]
            for n in (16, 32, 64)
        ]
    limit = found["balanced"][-1]
    eps = (H * 2 * np.pi / L) ** 2
    assert limit == pytest.approx(L - L * np.sin(2 * np.pi * (1 + 5 / 6 * eps)) / (2 * np.pi), abs=eps * L / 50)
    errors = {option: np.abs(np.array(values[:2]) - limit) for option, values in found.items()}
    assert np.all(errors["balanced"] < 0.02 * errors["projected"])
    assert np.log2(errors["balanced"][0] / errors["balanced"][1]) >= 3.0
    for option in ("projected", "nodal"):
        assert np.log2(errors[option][0] / errors[option][1]) == pytest.approx(2, abs=0.1)
    assert found["projected"][1] > limit > found["nodal"][1]  # too stiff, too soft


def half_pipe(interpolation: str, pressure: Pressure) -> ShellModel:
    grid = Grid.tensor(np.array([0.0, 0.4, 1.0]), np.linspace(0, np.pi, 7))
    fixed = np.zeros((grid.n_nodes, 6), bool)
    laminate = Laminate.single(Ply.isotropic(1.0, 0.3, 0.2))
    discretisation = Discretisation.build(cylinder(2.0), grid, laminate, fixed, interpolation=interpolation)
    return ShellModel(discretisation, EXACT, pressure=pressure)


def total(shell: ShellModel, forces: np.ndarray) -> np.ndarray:
    """Sum of nodal forces (n,) in Cartesian components."""
    nodal = forces.reshape(-1, 3, 2).sum(axis=2)
    frame = shell.discretisation.surface.frame(*shell.discretisation.grid.nodes.T)
    return np.einsum("ni,nix->x", nodal, frame)


def test_follower_pressure_on_interpolated_positions_is_the_area_vector_of_the_bilinear_faces(rng) -> None:
    """p int n dA of a bilinear face depends on its rim only: half the cross product of its diagonals."""
    shell = half_pipe("isoparametric", pressure=Pressure(0.7, follower=True, area="face"))
    u = 0.2 * rng.normal(size=shell.discretisation.n_free)
    force = shell.scaled(0.0).linearise(u).residual - shell.linearise(u).residual
    x = shell.discretisation.positions()[0] + shell.discretisation.cartesian(u)[0]
    corner = x[shell.discretisation.grid.elements]
    area = 0.5 * np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]).sum(axis=0)
    outwards = np.sign(area @ total(shell, force))
    assert total(shell, force) == pytest.approx(0.7 * outwards * area, rel=1e-10)


@pytest.mark.parametrize("interpolation", ["curvilinear", "isoparametric"])
def test_dead_loads_of_an_area_have_their_resultant(interpolation: str) -> None:
    """Normal pressure on a half pipe pushes by p times its diameter; a constant traction by itself times the area.

    A translation is in the space of the isoparametric element, so the sum is that of the Gauss points, 1e-4 for 30
    degrees each; of the curvilinear one only to O(l^2), the cosine of half an element.
    """
    shell = half_pipe(interpolation, pressure=Pressure(0.7))
    at_rest = np.zeros(shell.discretisation.n_free)
    force = total(shell, shell.scaled(0.0).linearise(at_rest).residual - shell.linearise(at_rest).residual)
    slack = 1e-3 if interpolation == "isoparametric" else np.pi**2 / 12**2 / 2
    assert np.abs(force) == pytest.approx([0.0, 0.7 * 2 * 2.0, 0.0], abs=0.7 * 4.0 * slack)
    dead = shell.discretisation.reduce(
        area_load(shell.discretisation, lambda a1, a2: np.broadcast_to([0.0, 0.0, -1.0], (*a1.shape, 3)))
    )
    assert total(shell, dead) == pytest.approx([0.0, 0.0, -2 * np.pi], abs=2 * np.pi * slack)
