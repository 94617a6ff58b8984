"""A problem as a deck for CalculiX, in the keywords that it shares with Abaqus.

Bricks are C3D20R or C3D20. St. Venant-Kirchhoff between Green strain and second Piola-Kirchhoff stress is what CalculiX
makes of ``*ELASTIC`` in a nonlinear step; Abaqus integrates a rate there, which differs by the order of the strain. It
also wants a table of its own for ``*DISTRIBUTION``, and TOTALS=YES for sums. The rigid plane is the face of
a brick that is moved by its nodes; contact is by pressure over penetration, without friction. No scene may enter here.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from formulations.section.laminate import Ply
from studies.ask.request import text_of
from studies.exchange.problem import INNER, OUTER, LoadStep, Plane, Problem, Supports, isotropic

ELEMENTS = {"reduced": "C3D20R", "full": "C3D20"}
A_LINE = 10  # numbers of a set on one line
LARGEST = 1e-9  # of the largest force: below it is rounding
OVER = 1.5  # half width of the plane over the largest distance of the body from its middle
STIFF = 100.0  # slope of the contact pressure over penetration, in units of the largest modulus over the thickness
FIRST, SMALLEST = 0.1, 1e-6  # of a step: its first increment, and the smallest
INCREMENTS = 10_000


def write_deck(path: Path, problem: Problem) -> None:
    """The deck as a file."""
    with path.open("w", encoding="ascii") as file:
        file.writelines(f"{line}\n" for line in deck(problem))


def deck(problem: Problem, integration: str = "") -> Iterator[str]:
    """Its lines; integration: of the bricks, see :func:`element`."""
    yield from _heading(problem)
    yield from _mesh(problem, element(problem, integration))
    yield from _sections(problem)
    yield from _supports(problem.supports)
    if problem.plane is not None:
        yield from _plane(problem, problem.plane)
    forces = [problem.supports.along_axes(step.forces) for step in problem.steps]
    most = np.max(np.abs(forces), axis=0)
    loaded = np.argwhere(most > LARGEST * most.max())
    for step, force in zip(problem.steps, forces, strict=True):
        yield from _step(problem, step, [(n, i, force[n, i]) for n, i in loaded])


def element(problem: Problem, integration: str = "") -> str:
    """Its name, by an integration of ELEMENTS.

    Without one it is reduced unless bricks stand in a single row: without a neighbour in two directions it keeps its
    hourglass modes.
    """
    bricks = problem.bricks
    across = len(bricks.elements) // len(bricks.inner)
    single_row = sorted((*problem.request.mesh, across))[1] == 1
    return ELEMENTS[integration or ("full" if single_row else "reduced")]


def contact_stiffness(problem: Problem) -> float:
    """STIFF times the largest modulus of a ply across the wall, over the thickness of the wall [MPa/mm]."""
    thickness = sum(ply.thickness for ply in problem.materials)
    return STIFF * max(ply.moduli[2] for ply in problem.materials) / thickness


def _heading(problem: Problem) -> Iterator[str]:
    request = problem.request
    yield "*HEADING"
    yield f"{problem.title}; mm, N, MPa"
    n1, n2 = request.mesh
    yield f"** footprint export {request.scene} --measure {request.measure} --mesh {n1}x{n2}"
    for key, value in request.settings.items():
        yield f"**   {key} = {text_of(value)}"


def _mesh(problem: Problem, kind: str) -> Iterator[str]:
    bricks = problem.bricks
    yield "*NODE, NSET=BODY"
    yield from (f"{i}, {_numbers(x)}" for i, x in enumerate(bricks.x, 1))
    yield f"*ELEMENT, TYPE={kind}, ELSET=BODY"
    for i, nodes in enumerate(bricks.elements + 1, 1):
        yield f"{i}, {', '.join(map(str, nodes[:10]))},"
        yield ", ".join(map(str, nodes[10:]))
    for ply in range(len(problem.materials)):
        yield from _set("ELSET", f"PLY_{ply + 1}", np.flatnonzero(bricks.ply == ply))
    for name, elements, face in (("INNER", bricks.inner, INNER), ("OUTER", bricks.outer, OUTER)):
        yield from _set("ELSET", f"ON_{name}", elements)
        yield f"*SURFACE, NAME={name}, TYPE=ELEMENT"
        yield f"ON_{name}, S{face}"
        yield from _set("NSET", name, bricks.face_nodes(face))
    yield from _set("NSET", "HELD", problem.supports.nodes)
    if problem.shell is not None:
        yield from _set("NSET", "SHELL", np.sort(problem.shell.ravel()))


def _sections(problem: Problem) -> Iterator[str]:
    for number, ply in enumerate(problem.materials, 1):
        yield f"*MATERIAL, NAME=PLY_{number}"
        orientation = "" if isotropic(ply) else f", ORIENTATION=PLY_{number}"
        yield from _elastic(ply)
        if orientation:
            yield from _orientation(problem, ply, number)
        yield f"*SOLID SECTION, ELSET=PLY_{number}, MATERIAL=PLY_{number}{orientation}"


def _elastic(ply: Ply) -> Iterator[str]:
    if isotropic(ply):
        yield "*ELASTIC"
        yield _numbers((ply.E_L, ply.nu_LT))
        return
    yield "*ELASTIC, TYPE=ENGINEERING CONSTANTS"
    yield _numbers((*ply.moduli, *ply.poisson, *ply.shears[:2]))
    yield _numbers(ply.shears[2:])


def _orientation(problem: Problem, ply: Ply, number: int) -> Iterator[str]:
    """Axes 1 and 2 of a ply in every one of its bricks: turned by its angle from a1 towards a2."""
    bricks = problem.bricks
    own = np.flatnonzero(bricks.ply == number - 1)
    c, s = np.cos(ply.angle), np.sin(ply.angle)
    e1, e2 = bricks.frame[own, 0], bricks.frame[own, 1]
    yield f"*DISTRIBUTION, NAME=AXES_{number}, LOCATION=ELEMENT"
    yield ", 1., 0., 0., 0., 1., 0."
    for element, axes in zip(own + 1, np.hstack([c * e1 + s * e2, c * e2 - s * e1]), strict=True):
        yield f"{element}, {_numbers(axes)}"
    yield f"*ORIENTATION, NAME=PLY_{number}, SYSTEM=RECTANGULAR"
    yield f"AXES_{number}"


def _supports(supports: Supports) -> Iterator[str]:
    """Components along the axes of each node; nodes with the same axes share one transformation."""
    turned = np.flatnonzero(supports.turned)
    if len(turned):
        axes, group = np.unique(np.round(supports.axes[turned, :2], 12), axis=0, return_inverse=True)
        for number, (first, second) in enumerate(axes, 1):
            yield from _set("NSET", f"TURNED_{number}", supports.nodes[turned[group.ravel() == number - 1]])
            yield f"*TRANSFORM, NSET=TURNED_{number}, TYPE=R"
            yield _numbers((*first, *second))
    held = np.where(supports.turned[:, None], supports.held, supports.cartesian)
    yield "*BOUNDARY"
    for node, components in zip(supports.nodes + 1, held, strict=True):
        yield from (f"{node}, {i}, {i}" for i in np.flatnonzero(components) + 1)


def _plane(problem: Problem, plane: Plane) -> Iterator[str]:
    """A brick of eight nodes, its first face towards the body, held but for its travel along the normal."""
    corners, count = plane_corners(problem, plane), len(problem.bricks.x)
    number = len(problem.bricks.elements) + 1
    yield "*NODE, NSET=PLANE"
    yield from (f"{count + i}, {_numbers(x)}" for i, x in enumerate(corners, 1))
    yield "*ELEMENT, TYPE=C3D8, ELSET=PLANE"
    yield f"{number}, {', '.join(str(count + i) for i in range(1, 9))}"
    yield "*MATERIAL, NAME=PLANE"
    yield "*ELASTIC"
    yield _numbers((max(ply.E_L for ply in problem.materials), 0.0))
    yield "*SOLID SECTION, ELSET=PLANE, MATERIAL=PLANE"
    yield "*SURFACE, NAME=PLANE, TYPE=ELEMENT"
    yield "PLANE, S1"
    yield "*SURFACE INTERACTION, NAME=TOUCH"
    yield "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"
    yield _numbers((contact_stiffness(problem),))
    yield "*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE"
    yield "OUTER, PLANE"


def plane_corners(problem: Problem, plane: Plane) -> np.ndarray:
    """(8, 3) corners of the brick whose first face is the plane at its start, larger than what may come to it."""
    n = plane.normal
    first = np.linalg.svd(n[None, :])[2][1]
    second = np.cross(n, first)
    x = problem.bricks.x
    middle = 0.5 * (x.max(axis=0) + x.min(axis=0))
    middle = middle + (plane.start - n @ middle) * n
    half = OVER * float(np.max(np.linalg.norm(x - x.mean(axis=0), axis=1)))
    square = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    near = np.array([middle + half * (a * first + b * second) for a, b in square])
    return np.concatenate([near, near + half * n])


def _step(problem: Problem, step: LoadStep, forces: Sequence[tuple[int, int, float]]) -> Iterator[str]:
    """Each load changes linearly from its value in the step before; forces: node, component and value of all of them.

    What is loaded in any step is written in every one, zeros included: to take loads away and put them on again would
    let the program ramp them up from nothing.
    """
    bricks, plane = problem.bricks, problem.plane
    yield f"** {step.name}"
    large = ", NLGEOM" if problem.nonlinear else ""
    yield f"*STEP{large}, INC={INCREMENTS}"
    yield "*STATIC"
    if problem.nonlinear or plane is not None:
        yield _numbers((FIRST, 1.0, SMALLEST, 1.0))
    if forces:
        yield "*CLOAD"
        yield from (f"{n + 1}, {i + 1}, {_numbers((force,))}" for n, i, force in forces)
    pressed = np.flatnonzero(np.any([each.pressure for each in problem.steps], axis=0))
    if len(pressed):
        yield "*DLOAD"
        yield from (f"{bricks.inner[i] + 1}, P{INNER}, {_numbers((step.pressure[i],))}" for i in pressed)
    if plane is not None and step.offset is not None:
        yield "*BOUNDARY"
        travel = (step.offset - plane.start) * plane.normal
        yield from (f"PLANE, {i}, {i}, {_numbers((travel[i - 1],))}" for i in (1, 2, 3))
    yield from _output(problem)
    yield "*END STEP"


def _output(problem: Problem) -> Iterator[str]:
    """Once a step: displacements, sums of forces on supports and plane, strain energy; what is drawn in a file."""
    once = f"FREQUENCY={INCREMENTS}"
    yield f"*NODE PRINT, NSET=BODY, GLOBAL=YES, {once}"
    yield "U"
    for name in ("HELD", *(["PLANE"] if problem.plane is not None else [])):
        yield f"*NODE PRINT, NSET={name}, TOTALS=ONLY, GLOBAL=YES, {once}"
        yield "RF"
    yield f"*EL PRINT, ELSET=BODY, TOTALS=ONLY, {once}"
    yield "ELSE"
    yield f"*NODE FILE, {once}"
    yield "U"


def _set(kind: str, name: str, members: Iterable[int] | np.ndarray) -> Iterator[str]:
    yield f"*{kind}, {kind}={name}"
    numbers = [str(int(member) + 1) for member in members]
    yield from (", ".join(numbers[i : i + A_LINE]) + "," for i in range(0, len(numbers), A_LINE))


def _numbers(values: Sequence[float] | np.ndarray) -> str:
    """At most 20 letters each, as CalculiX reads them."""
    return ", ".join(f"{float(value) + 0.0:.12g}" for value in values)
