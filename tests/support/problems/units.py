"""The same contact problem and the same state in other units of length and stress."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from contact.problem import ContactProblem, ContactSolution, Linearisation


@dataclass(frozen=True)
class Units:
    """How many units a mm and a MPa are taken as; powers of 4 change no digit of any number, not even of a root."""

    length: float = 1.0
    stress: float = 1.0

    @property
    def force(self) -> float:
        """Units of force in a N."""
        return self.stress * self.length**2

    @property
    def stiffness(self) -> float:
        """Units of an epsilon in a MPa/mm."""
        return self.stress / self.length

    def of(self, problem: ContactProblem) -> ContactProblem:
        """The problem in these units; without balances and choice of candidates."""
        length, force, curvature = self.length, self.force, problem.gap_curvature

        def linearise(u: np.ndarray, memory: object) -> Linearisation:
            lin = problem.linearise(u / length, memory)
            return Linearisation(
                force * lin.residual,
                force / length * lin.tangent,
                force * lin.scale,
                lambda du: lin.remember(du / length),
            )

        return replace(
            problem,
            linearise=linearise,
            gap=lambda u: length * problem.gap(u / length),
            gap_jacobian=lambda u: problem.gap_jacobian(u / length),
            weights=length**2 * problem.weights,
            coupling=None if problem.coupling is None else length**2 * problem.coupling,
            gap_curvature=None if curvature is None else lambda u, f: curvature(u / length, f) / length,
            gap_size=length * problem.gap_size,
            energy=None,
            directions=None,
            others=None,
            residual=None,
            only=None,
            travel=None,
        )

    def state(self, solution: ContactSolution) -> ContactSolution:
        """A state in these units."""
        return replace(solution, u=self.length * solution.u, pressure=self.stress * solution.pressure)


FAR = 4.0**20  # 1.1e12
UNITS = {
    "far longer": Units(length=FAR),
    "far shorter": Units(length=1 / FAR),
    "far stiffer": Units(stress=FAR),
    "far softer": Units(stress=1 / FAR),
}
