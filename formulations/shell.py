"""The shell model: surface, grid, section, measure, supports and loads as one function of the free displacements.

``linearise(u, memory)`` serves ANY measure, plain and mixed Newton. Parts are frozen records; state goes in and comes
out; the only mutable things are scratch arrays: what the element methods return lies in them, until the next of these
methods is called. No contact may enter here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse
from scipy.linalg import norm

from formulations.discretisation import Discretisation
from formulations.element.mixed import MixedElement
from formulations.element.modal import ModalElement, Stiffness
from formulations.element.strain_operator import N_DOF
from formulations.section.laminate import LINEAR, SECTIONS
from formulations.shell_readings import ShellReadings, along, less
from formulations.strains.measure import QuadraticMeasure, StrainMeasure
from formulations.strains.quantities import N_E, N_Q

if TYPE_CHECKING:
    from formulations.loads import Couples, Pressure

NEWTONS = ("plain", "mixed")
BENDINGS = ("chord", "arc")


@dataclass(frozen=True, eq=False)
class Linearisation:
    """Residual r(u) (n,) = internal - external force [N], tangent dr/du (n, n) CSC [N/mm], force scale [N].

    ``scale`` is the larger norm of the internal and the external force (with prescribed displacements the internal
    force counts on all displacements, reactions included): residuals are judged relative to it.
    ``remember(du)`` returns the memory to pass on after the step du (None where nothing is remembered).
    """

    residual: np.ndarray
    tangent: sparse.csc_matrix
    scale: float
    remember: Callable[[np.ndarray], object]


@dataclass(frozen=True, eq=False)
class ShellModel(ShellReadings):
    """A loaded shell.

    forces (n,): dead nodal forces on the free displacements, in the local frames [N].  initial (11,): resultants H0 of
    the reference state [N/mm].  newton: "plain" or "mixed" (the resultants predicted by the last linear step build the
    geometric stiffness: the mixed-integration-point strategy of Magisano, Leonetti, Garcea, 2017).
    thickness_strain: "projected" (the paper), "balanced" or "nodal"; membrane: "compatible" (the paper) or "relaxed",
    see :class:`formulations.element.mixed.MixedElement`.  bending: of the "chord" of an element that folds (the paper),
    or of the "arc", which needs "nodal", see :mod:`formulations.element.arc_element`.  couples: follow the directors of
    their nodes.
    prescribed (N, 6): values of the held displacements, 0 elsewhere; u = expand(free) + prescribed. Raises ValueError
    when one is free. What is held midway between the faces has one value on both.
    A step of them starts wholly in the elements at the support: large ones may lead to another equilibrium, so --steps.
    """

    discretisation: Discretisation
    measure: StrainMeasure
    section: str = "constant-s33"
    law: str = LINEAR
    newton: str = "mixed"
    pressure: Pressure | None = None
    forces: np.ndarray | None = None
    initial: np.ndarray | None = None
    thickness_strain: str = "projected"
    membrane: str = "compatible"
    bending: str = BENDINGS[0]
    couples: Couples | None = None
    prescribed: np.ndarray | None = None
    _element: ModalElement = field(init=False, repr=False)
    _dead: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if self.newton not in NEWTONS:
            raise ValueError(f"newton {self.newton!r} is not one of {', '.join(NEWTONS)}")
        if self.bending not in BENDINGS:
            raise ValueError(f"bending {self.bending!r} is not one of {', '.join(BENDINGS)}")
        if self.discretisation.geometry.kinematics != self.measure.kinematics:
            object.__setattr__(self, "discretisation", self.discretisation.leaving_out(self.measure.kinematics))
        shell = self.discretisation
        if self.prescribed is not None:
            midway = self.prescribed.reshape(-1, 3, 2)[shell.map.hinged.reshape(-1, 3, 2)[..., 0]]
            if np.any(self.prescribed[~(shell.map.held | shell.map.hinged)] != 0) or np.any(np.diff(midway) != 0):
                raise ValueError("a prescribed displacement must be held, midway between the faces alike on both")
        initial = np.zeros(N_E) if self.initial is None else np.asarray(self.initial, float)
        object.__setattr__(self, "_element", self._built(self.discretisation, initial))
        if self.linear:
            object.__setattr__(self, "discretisation", self.discretisation.linearised())
        object.__setattr__(self, "_dead", self._dead_contributions())

    def _built(self, shell: Discretisation, initial: np.ndarray) -> ModalElement:
        options, interpolation = (self.thickness_strain, self.membrane), shell.geometry.interpolation
        arcs = self.bending != BENDINGS[0]
        if arcs:
            from formulations.element.arc_element import ArcElement, refusal  # loaded with arcs alone

            why = refusal(self.thickness_strain, interpolation, self.measure, two_faces=shell.wall is None)
            if why:
                raise ValueError(why)
        if shell.wall is not None:
            if self.section != SECTIONS[0]:
                raise ValueError(f"section {self.section!r} applies to two faces only, not to surfaces inside the wall")
            from formulations.element.walls.law import WallLaw  # loaded with surfaces inside the wall alone
            from formulations.element.walls.sampling_element import SamplingElement

            law = WallLaw.of(shell.wall.sampling, shell.wall.growth, self.law, shell.wall.angles)
            return SamplingElement.build(self.measure, shell.wall, law, initial, *options)
        if self.law != LINEAR:
            raise ValueError(f"law {self.law!r} needs surfaces inside the wall, where it is met at points")
        element = MixedElement.build(self.measure, shell.laminate.stiffness(self.section), initial, *options)
        if arcs:
            at = shell.surface.geometry(*shell.grid.centre.T)
            sides, thickness = 2 * shell.grid.half * at.A, shell.laminate.thickness
            return ArcElement.on(element, sides / thickness, at.k * sides, positions=interpolation == "isoparametric")
        if interpolation != "quads":
            return element
        from formulations.element.quad_element import QuadElement  # loaded with quadrilaterals alone
        from formulations.element.quad_geometry import QuadGeometry

        assert isinstance(shell.geometry, QuadGeometry)
        own = shell.stiffness(self.section)
        return QuadElement.on(shell.geometry, element, own, initial, self.thickness_strain)

    @property
    def powers(self) -> list[tuple[int, int]]:
        """(r1, r2) of the mode of each mode strain."""
        return self._element.powers

    @property
    def linear(self) -> bool:
        """Whether all strains are linear in the displacements: their size then means nothing."""
        return not np.any(self.measure.contract(np.zeros(N_Q), np.ones(N_E)))

    @property
    def ordered(self) -> bool:
        """Whether the unknowns are numbered for elimination, so that a factorisation need not look for an order."""
        return self.discretisation.ordered

    def scaled(self, factor: float) -> ShellModel:
        """The same shell under ``factor`` times its pressure, forces, couples and prescribed displacements."""
        if factor == 1.0:
            return self
        return replace(
            self,
            pressure=self.pressure and self.pressure.scaled(factor),
            forces=None if self.forces is None else factor * self.forces,
            couples=self.couples and self.couples.scaled(factor),
            prescribed=None if self.prescribed is None else factor * self.prescribed,
        )

    def linearise(self, u: np.ndarray, memory: object = None) -> Linearisation:
        """Residual, tangent and what to remember at the free displacements u (n,).

        ``memory`` is what ``remember`` of the last step returned, or None. Only the mixed Newton uses it.
        """
        v = self.displacements(u)
        shell = self.discretisation.at(v)
        force, tangent = shell.scratch
        mixed, element = self.newton == "mixed", self._element  # what is remembered cannot lie in the scratch
        B = np.empty((len(force), element.n_modes, force.shape[1])) if mixed else None
        slopes: list[Stiffness] = []
        H, external = self._integrate(self._element_vectors(u), memory, force, tangent, B, slopes if mixed else None)
        internal, outside = shell.gather(force), self._outside(shell, external)
        inside = internal if self.prescribed is None else shell.nodal(force)
        if shell.hangers is not None:
            shell.hangers.stiffen(tangent, v, shell.on_nodes(less(force, self._loads(external))))
        return Linearisation(
            residual=internal - outside,
            tangent=shell.assemble(tangent),
            scale=float(max(norm(inside, check_finite=False), norm(outside, check_finite=False))),
            remember=lambda du: None if B is None else H + element.change(shell.geometry, along(B, shell, du), slopes),
        )

    @property
    def quadratic(self) -> str | None:
        """None where the internal force is a polynomial of u and the load is dead; else what is not."""
        if not isinstance(self.measure, QuadraticMeasure):
            return f"measure {self.measure.name} is not quadratic in the displacements"
        if self.discretisation.hangers is not None:
            return "hanging nodes turn with the edges that carry them"
        if type(self._element) is not MixedElement:
            return "quadrilaterals, arcs and surfaces inside the wall have no series yet"
        if self.couples is not None or (self.pressure is not None and self.pressure.follower):
            return "the load follows the shell"
        return None

    @property
    def polynomial(self) -> MixedElement:
        """The element of a shell whose path may be a power series; raises ValueError where it is none."""
        if self.quadratic is not None:
            raise ValueError(self.quadratic)
        assert isinstance(self._element, MixedElement)
        return self._element

    def residual(self, u: np.ndarray) -> np.ndarray:
        """The residual of :meth:`linearise` alone."""
        force, external = self.element_forces(u)
        shell = self._at(u)
        return shell.gather(force) - self._outside(shell, external)

    def _outside(self, shell: Discretisation, external: np.ndarray | None) -> np.ndarray:
        outside = shell.gather(self._dead)
        if self.forces is not None:
            outside = outside + self.forces
        return outside if external is None else outside + shell.gather(external)

    def energy(self, u: np.ndarray) -> float:
        """Strain energy minus the work of the dead loads [N mm]; the potential when D is symmetric and H0 zero."""
        strain_energy = self._element.energy(self.discretisation.geometry, self._element_vectors(u))
        work = float(np.sum(self._dead * self._element_vectors(u)[:, : self._dead.shape[1]]))
        return strain_energy - (work if self.forces is None else work + float(self.forces @ u))

    @property
    def conservative(self) -> bool:
        """True when :meth:`energy` is the potential of the residual: D symmetric, dead loads, H0 zero."""
        symmetric = self.discretisation.wall is not None or _symmetric(self.discretisation.stiffness(self.section))
        follows = self.couples is not None or (self.pressure is not None and self.pressure.follower)
        return symmetric and not follows and (self.initial is None or not np.any(self.initial))

    def element_contributions(self, u: np.ndarray, memory: object) -> tuple[np.ndarray, np.ndarray | None, np.ndarray]:
        """Element forces (E, 24), external ones that follow (or None), tangents (E, 24, 24), until the next call."""
        force, tangent = self.discretisation.scratch
        _, external = self._integrate(self._element_vectors(u), memory, force, tangent)
        return force, external, tangent

    def element_forces(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray | None]:
        """The forces of :meth:`element_contributions` alone, for half its cost."""
        force, _ = self.discretisation.scratch
        _, external = self._integrate(self._element_vectors(u), None, force)
        return force, external

    def _integrate(
        self,
        v: np.ndarray,
        memory: object,
        force: np.ndarray,
        tangent: np.ndarray | None = None,
        mode_gradient: np.ndarray | None = None,
        slopes: list[Stiffness] | None = None,
    ) -> tuple[np.ndarray, np.ndarray | None]:
        """Resultants (E, 22), external forces that follow (or None); the rest: see ModalElement.integrate."""
        geometry = self.discretisation.geometry
        predicted = memory if isinstance(memory, np.ndarray) else None
        resultants = self._element.integrate(geometry, v, predicted, force, tangent, mode_gradient, slopes)
        pressure = self.pressure if self.pressure is not None and self.pressure.follower else None
        if pressure is None and self.couples is None:
            return resultants, None
        external, v = np.zeros((len(force), N_DOF)), v[:, :N_DOF]
        of_faces = None if tangent is None else tangent[:, :N_DOF, :N_DOF]
        if pressure is not None:
            pressure.follower_force(geometry, v, external, of_faces)
        if self.couples is not None:
            self.couples.follower_force(self.discretisation.grid, v, external, of_faces)
        return resultants, external

    def work_of_pressure(self, u: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Work W [N mm] of a follower pressure from rest to u, its force and dW/du (n,): see :meth:`Pressure.work`."""
        assert self.pressure is not None
        v = self._element_vectors(u)[:, :N_DOF]
        work, force, gradient = self.pressure.work(self.discretisation.geometry, v)
        shell = self._at(u)
        return work, shell.gather(force), shell.gather(gradient)

    def _dead_contributions(self) -> np.ndarray:
        """Element forces (E, 24) of dead pressure and of H0 on the linear strains."""
        geometry = self.discretisation.geometry
        constant = self._element.linear_initial_force(geometry, self.discretisation.dofs.shape[1])
        if self.pressure is not None and not self.pressure.follower:
            constant[:, :N_DOF] += self.pressure.dead_force(geometry)
        return constant


def _symmetric(D: np.ndarray) -> bool:
    return bool(np.max(np.abs(D - D.swapaxes(-1, -2))) <= 1e-12 * np.max(np.abs(D)))
