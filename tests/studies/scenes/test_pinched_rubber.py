"""The pinched rubber cylinder against a solid of the same law, and a ring that does not stretch."""

import numpy as np
import pytest

from contact.algorithms.semismooth import Semismooth
from contact.continuation.load_stepping import follow
from contact.problem import ContactSolution, without_contact
from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from formulations.section.laws import LAWS
from formulations.solid import SolidDiscretisation, SolidModel
from formulations.solid_mesh import SolidMesh
from studies.scenes.benchmarks.rubber import SOLID, UNIT, WALL, PinchedRubber
from support.problems.solved import read, solved

END, SIDE = PinchedRubber.LENGTH / 2, np.pi / 2


def approaches(law: str, n1: int, n2: int, n3: int) -> list[float]:
    """Of a solid under the loads of the references [mm]."""
    laminate = Laminate.single(Ply.isotropic(PinchedRubber.E, PinchedRubber.NU, WALL))
    lines = np.linspace(0, END, n1 + 1), np.linspace(0, SIDE, n2 + 1)
    mesh = SolidMesh.build(cylinder(PinchedRubber.RADIUS), *lines, laminate, per_ply=n3)
    fixed = np.zeros((len(mesh.x), 3), bool)
    fixed[mesh.on(1, 0.0), 1] = fixed[mesh.on(1, SIDE), 0] = fixed[mesh.on(0, 0.0), 2] = True
    body, forces = SolidDiscretisation.build(mesh, laminate, fixed, LAWS[law]), np.zeros((len(mesh.x), 3))
    shares = np.zeros(2 * n1 + 1)
    for first in range(0, 2 * n1, 2):
        shares[first : first + 3] += np.array([1, 4, 1]) / 6 / n1
    for d in (-WALL / 2, WALL / 2):
        line = np.intersect1d(mesh.on(1, 0.0), mesh.on(2, d))
        forces[line[np.argsort(mesh.parameter[line, 0])], 0] = -UNIT / 8 * shares
    loaded = SolidModel(body, forces=forces.ravel()[body.free])
    (under,) = np.intersect1d(np.intersect1d(mesh.on(1, 0.0), mesh.on(2, 0.0)), mesh.on(0, 0.0))
    at_rest = ContactSolution.at_rest(body.n_free, 0)
    found = []
    for point in follow(
        lambda t: without_contact(loaded.scaled(t).linearise, body.n_free), 0.0, tuple(SOLID), Semismooth(), at_rest
    ):
        assert point.outcome.converged
        found.append(float(-2 * body.expand(point.solution.u)[under, 0]))
    return found


@pytest.mark.slow
def test_five_surfaces_are_the_solid_of_their_law() -> None:
    """In the limit of two meshes, whose order is 2; the references are those of a finer solid."""
    solid = np.array([approach for approach, _ in SOLID.values()])
    assert approaches("neo-hooke", 6, 12, 3) == pytest.approx(solid, rel=5e-3)
    for surfaces, within in (("5", 3e-3), ("3", 3e-2)):
        meshes = (solved("pinched-rubber", mesh, surfaces=surfaces) for mesh in ("12x12", "24x24"))
        coarse, fine = (read(result, "approach_mm") for result in meshes)
        assert fine + (fine - coarse) / 3 == pytest.approx(solid, rel=within)


@pytest.mark.slow
def test_the_law_changes_shell_and_solid_alike() -> None:
    """A linear law is 8 % softer at the end, where the inner face is compressed by a quarter."""
    soft = approaches("svk", 4, 12, 2)[-1] / approaches("neo-hooke", 4, 12, 2)[-1]
    shell = [solved("pinched-rubber", "16x16", law=law).quantities["approach_mm"] for law in ("svk", "neo-hooke")]
    assert soft > 1.07
    assert shell[0] / shell[1] == pytest.approx(soft, rel=5e-3)


def test_a_thin_cylinder_is_pinched_as_a_ring_between_plane_stress_and_plane_strain() -> None:
    """(pi/4 - 2/pi) P R^3/(E I) of an inextensible ring, at a hundredth of the load, which is 1 % of its diameter."""
    h, load = 2.0, 0.01
    ring = (
        (np.pi / 4 - 2 / np.pi)
        * load
        * UNIT
        * (h / WALL) ** 3
        * PinchedRubber.RADIUS**3
        / (PinchedRubber.E * PinchedRubber.LENGTH * h**3 / 12)
    )
    asked = {"h_mm": repr(h), "load_fraction": repr(load), "surfaces": "3"}
    approach = solved("pinched-rubber", "8x16", **asked).quantities["approach_mm"]
    assert (1 - PinchedRubber.NU**2) * ring < approach < ring
