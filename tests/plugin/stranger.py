"""A clamped arch pressed by a rigid plane: half of it, the plane moving down on the crown."""

import math
from collections import Counter
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from contact.algorithms.regularised import Regularised
from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.obstacles.foundation import RigidPlane
from contact.parameters import SHARED, STIFFNESS, Parameter
from formulations.conditions.boundary import Supports
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from formulations.strains.catalogue import EXACT_TERMS, MEASURES
from formulations.strains.measure import RigidBodyLaw, quadratic_measure
from studies.ask.scene import EPSILON, SOLVER, Reference, Setting
from studies.scenes import SCENES
from studies.scenes.contact.base import ContactModel
from studies.scenes.element import ELEMENT, discretise
from studies.scenes.statics import loaded_shell

NO_DRILLING = quadratic_measure(
    "no-drilling",
    EXACT_TERMS | {f"E{a}{a}": {f"l{a}": 1, f"l{a} l{a}": 1 / 2, f"t{a} t{a}": 1 / 2} for a in (1, 2)},
    meaning="Green-Lagrange strain; neglects the squares of w",
    reference="made up",
    rigid_body_law=RigidBodyLaw(drilling=lambda theta, zeta: -(math.sin(theta) ** 2) / 2),
)


@dataclass(frozen=True)
class Stiffening:
    """Springs of growing stiffness, and the constraint from the set that they end with.

    Source: made up.
    """

    epsilon: float = math.inf
    first: float = 10.0
    rounds: int = 2
    solver: str = "splu"
    tolerance: float = 1e-9
    name: ClassVar[str] = "stiffening"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        *SHARED,
        Parameter("first", "stiffness of the first springs", STIFFNESS, low=0, open_low=True),
        Parameter("rounds", "times that it grows tenfold", kind="int", low=1, high=6),
    )

    def supports(self, problem):
        """Applies to every problem."""
        return None

    def solve(self, problem, start):
        counters, solution = Counter(), start
        for epsilon in (*(self.first * 10.0**k for k in range(self.rounds)), self.epsilon):
            method = Semismooth if math.isinf(epsilon) else Regularised
            solution = method(epsilon=epsilon, solver=self.solver, tolerance=self.tolerance).solve(problem, solution)
            counters.update(solution.counters)
        return replace(solution, counters=dict(counters))


E, R, WIDTH, H, ANGLE = 1e3, 100.0, 20.0, 8.0, math.pi / 3  # MPa, mm
TRAVEL = Setting("delta_mm", (1.0, 2.0), "travel of the plane from first touch", "floats", 0, 40, open_low=True)


@dataclass(frozen=True)
class Arch:
    name: str = "pressed-arch"
    title: str = "Clamped arch pressed by a plane"
    default_mesh: tuple = (1, 16)
    settings: tuple = (TRAVEL, EPSILON, *ELEMENT, SOLVER)
    references: tuple = (
        Reference("force_N", 335.19, {"delta_mm": 2.0, "measure": "exact"}, "computed", "mesh 1x64", 5e-3),
    )

    def build(self, request):
        n1, n2 = request.mesh
        grid = Grid.tensor(np.linspace(0, WIDTH, n1 + 1), np.linspace(0, ANGLE, n2 + 1))  # a2 from the crown
        crown, foot = grid.on_line(1, 0.0), grid.on_line(1, ANGLE)
        laminate = Laminate.single(Ply.isotropic(E, 0.3, H))
        supports = Supports.none(grid).symmetric(crown, 1).clamped(foot)
        discretisation = discretise(request, cylinder(R), grid, laminate, *supports.masks)
        shell = loaded_shell(discretisation, request)
        return ContactModel(
            shell=shell,
            held=foot,
            targets=request.numbers("delta_mm"),
            plane_at=lambda delta: RigidPlane(np.array([1.0, 0.0, 0.0]), R + H / 2 - delta),
            measure_at=lambda delta, touch: {"force_N": 2 * float(touch.force.sum())},
            key="delta_mm",
            body_at=lambda delta: shell,
        )


ARCH = Arch()
MEASURES[NO_DRILLING.name] = NO_DRILLING
ALGORITHMS[Stiffening.name] = Stiffening
SCENES[ARCH.name] = ARCH
