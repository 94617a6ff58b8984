"""What is read off a state with friction: resultants, and a table of the candidates that touch. Nothing is solved."""

from typing import Any

import numpy as np

from contact.coulomb import State
from contact.faces.rubbing import Rubbing
from contact.faces.rubbings import Rubbings
from contact.problem import ContactProblem, ContactSolution
from contact.slip import slip_of
from studies.ask.scene import Units
from studies.output.atomic import Table

FRICTION = "friction"  # the table
RESULTANT = "friction_N"
FORCES = (
    RESULTANT,
    "bound_N",
    "moment_N_mm",
    "moment_bound_N_mm",
    "sticking",
    "slipping",
    "dissipation_N_mm",
)
COMPONENTS = tuple(f"friction_{axis}_N" for axis in "xyz")


def forces(problem: ContactProblem, state: ContactSolution, units: Units) -> dict[str, float]:
    """Resultants over the part that is solved, in the order of :data:`FORCES`.

    friction_N: length of the resultant.  bound_N: sum of mu f.  moment_N_mm: of friction about the normal through the
    origin of the surface, where the foundation is turned, or of space between two faces; moment_bound_N_mm: its value
    if all slip around there, the sum of mu f r.  sticking, slipping: candidates.  dissipation_N_mm: of the path so far.
    units: of the problem.
    """
    assert problem.coulomb is not None
    assert state.friction is not None
    (y, normals), pull = _candidates(problem, state), in_space(problem, state)
    f = problem.nodal_forces(state.pressure)
    normal = np.sum(f[:, None] * normals, axis=0)
    axis = normal / (float(np.linalg.norm(normal)) or 1.0)
    arm = y - np.outer(y @ axis, axis)
    bound = problem.coulomb.bound(f)
    work = units.force * units.length
    values = (
        np.linalg.norm(pull.sum(axis=0)) / units.force,
        bound.sum() / units.force,
        np.cross(arm, pull).sum(axis=0) @ axis / work,
        bound @ np.linalg.norm(arm, axis=1) / work,
        np.sum(state.friction.state == State.STICK),
        np.sum(state.friction.state == State.SLIP),
        state.friction.dissipation / work,
    )
    return dict(zip(FORCES, map(float, values), strict=True))


def _candidates(problem: ContactProblem, state: ContactSolution) -> tuple[np.ndarray, np.ndarray]:
    """Where the candidates are, and the normals of what they touch there, (m, 3) each."""
    sliding = slip_of(problem, state.rubbed.since)
    if isinstance(sliding, Rubbing | Rubbings):
        return sliding.on_faces(state.u)
    assert problem.surface is not None
    y = problem.surface.positions(state.u)
    return y, problem.surface.gradient(y)


def in_space(problem: ContactProblem, state: ContactSolution) -> np.ndarray:
    """Friction (m, 3) [N] of the foundation on each candidate."""
    return slip_of(problem, state.rubbed.since).in_space(state.u, state.rubbed.force)


def nodal(problem: ContactProblem, state: ContactSolution, units: Units) -> Table:
    """The candidates that touch: place, normal force, friction, slip of the last step, area, and whether they stick."""
    assert state.friction is not None
    touch = np.flatnonzero(state.friction.state != State.OPEN)
    slip = slip_of(problem, state.friction.since)
    y, slips = (each[touch] / units.length for each in (_candidates(problem, state)[0], slip(state.u)))
    normal, pull = problem.nodal_forces(state.pressure)[touch], in_space(problem, state)[touch] / units.force
    columns: dict[str, Any] = {"candidate": touch, "normal_N": normal / units.force}
    columns |= {f"{axis}_mm": y[:, i] for i, axis in enumerate("xyz")}
    columns |= {name: pull[:, i] for i, name in enumerate(COMPONENTS)}
    columns |= {"slip_mm": np.linalg.norm(slips, axis=1), "area_mm2": problem.weights[touch] / units.length**2}
    return Table.of({**columns, "sticks": (state.friction.state[touch] == State.STICK).astype(int)})


def resultant(table: Table) -> np.ndarray:
    """(3,) [N] of the friction of all candidates that touch, whose table is that of :func:`nodal`."""
    return np.array([sum(table.columns[name]) for name in COMPONENTS], float)
