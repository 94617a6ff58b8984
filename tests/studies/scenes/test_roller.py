"""The rubber roller against a plane solid of the same law, and Hertz."""

import numpy as np
import pytest

from contact.algorithms.semismooth import Semismooth
from contact.continuation.load_stepping import follow
from contact.obstacles.foundation import Candidates, RigidPlane, against
from contact.problem import ContactSolution
from formulations.geometry.grid import graded_lines
from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from formulations.section.laws import LAWS
from formulations.solid import SolidDiscretisation, SolidModel
from formulations.solid_mesh import SolidMesh
from studies.ask.request import UsageError
from studies.scenes.complete import complete
from studies.scenes.contact.roller import AWAY, BORE, NU, OUTER, PATCH, SLICE, SOLID, WIDTH, E, contact_width, hertz
from support.problems.solved import read, solved

TRAVELS = ",".join(map(repr, SOLID))


def plane_solid(law: str, around: int, through: int) -> np.ndarray:
    """Force [N], width [mm] and pressure [MPa] at the travels of the references."""
    wall = Laminate.single(Ply.isotropic(E, NU, OUTER - BORE))
    lines = np.array([0.0, SLICE]), graded_lines([0.0, PATCH, np.pi], [around // 2, around // 2])
    mesh = SolidMesh.build(cylinder((OUTER + BORE) / 2), *lines, wall, per_ply=through)
    fixed = np.zeros((len(mesh.x), 3), bool)
    fixed[:, 2] = True
    fixed[np.append(mesh.on(1, 0.0), mesh.on(1, np.pi)), 1] = True
    fixed[mesh.on(2, wall.d_minus)] = True
    body = SolidDiscretisation.build(mesh, wall, fixed, LAWS[law])
    nodes = np.setdiff1d(np.unique(mesh.outer), mesh.on(1, np.pi))
    outer = Candidates(mesh.x[nodes], body.displacement_operator(nodes), mesh.face_areas(mesh.outer)[nodes])
    line = np.flatnonzero(np.isclose(mesh.parameter[nodes, 0], 0.0))
    line = line[np.argsort(mesh.parameter[nodes[line], 1])]
    found = []
    for point in follow(
        lambda delta: against(SolidModel(body).linearise, outer, RigidPlane(AWAY, OUTER - delta)),
        0.0,
        tuple(SOLID),
        Semismooth(),
        ContactSolution.at_rest(body.n_free, len(nodes)),
    ):
        assert point.outcome.converged
        state = point.solution
        force = 2 * WIDTH / SLICE * float(outer.weights @ state.pressure)
        width = contact_width(outer.positions(state.u)[line, 1], state.active[line], state.pressure[line])
        found.append((force, width, state.pressure[line[0]]))
    return np.array(found)


def of_shell(**settings: str) -> np.ndarray:
    result = solved("roller", delta_mm=TRAVELS, **settings)
    assert all(step["stability"]["negative"] == 0 for step in result.steps)
    return np.array([read(result, name) for name in ("force_N", "width_mm", "pressure_MPa")]).T


@pytest.mark.slow
def test_five_surfaces_have_the_forces_and_pressures_of_the_solid() -> None:
    solid = np.array(list(SOLID.values()))
    assert of_shell()[:, 0] == pytest.approx(solid[:, 0], rel=1e-3)
    assert of_shell(surfaces="7")[:, ::2] == pytest.approx(solid, rel=3e-3)
    assert of_shell(surfaces="3")[:, 0] == pytest.approx(solid[:, 0], rel=1.2e-2)


@pytest.mark.slow
@pytest.mark.parametrize("law", ["svk", "neo-hooke"])
def test_a_solid_of_any_law_has_the_contact_of_the_shell(law) -> None:
    """Half as fine along the wall as that of the references; widths are known to a share of an element."""
    solid, shell = plane_solid(law, 32, 8), of_shell(law=law)
    if law == "neo-hooke":
        assert solid[:, ::2] == pytest.approx(np.array(list(SOLID.values())), rel=0.013)
    assert shell[:, 0] == pytest.approx(solid[:, 0], rel=2e-3)
    assert shell[:, 1] == pytest.approx(solid[:, 1], rel=2e-2)


def test_hertz_is_that_of_the_thread_and_rubber_on_a_bore_is_harder() -> None:
    """26 mm and 0.66 MPa at 380 N."""
    assert hertz(380.0, E, NU) == pytest.approx((26.1, 0.662), rel=2e-3)
    found = solved("roller", delta_mm="1,2,2.568").quantities
    assert found["force_N"] == pytest.approx(380.0, rel=1e-3)
    width, pressure = hertz(found["force_N"], E, NU)
    assert found["width_over_hertz"] == pytest.approx(found["width_mm"] / width)
    assert found["pressure_over_hertz"] == pytest.approx(found["pressure_MPa"] / pressure)
    assert found["width_over_hertz"] < 0.9 < 1.2 < found["pressure_over_hertz"]


def test_an_odd_number_of_elements_around_is_refused() -> None:
    scene, request = complete("roller", {}, "1x33")
    with pytest.raises(UsageError, match="1x33: the second number must be even"):
        scene.build(request)
