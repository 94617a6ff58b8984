"""The shell model: surface, grid, section, measure, supports and loads as one function of the free displacements.

``linearise(u, memory)`` serves ANY measure, plain and mixed Newton. Parts are frozen records; state goes in and comes
out; the only mutable things are scratch arrays: what the element methods return lies in them, until the next of these
methods is called. No contact may enter here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import sparse
from scipy.linalg import norm

from formulations.discretisation import Discretisation
from formulations.element.arc_element import ArcElement, refusal
from formulations.element.mixed import MixedElement
from formulations.element.modal import ModalElement, Stiffness
from formulations.element.quad_element import QuadElement
from formulations.element.quad_geometry import QuadGeometry
from formulations.element.series import ElementSeries
from formulations.element.strain_operator import N_DOF, shape_functions
from formulations.loads.pressure import Couples, Pressure
from formulations.section.laminate import PLANE, SECTIONS, strain_rotation
from formulations.section.laws import LINEAR
from formulations.strains.measure import QuadraticMeasure, StrainMeasure
from formulations.strains.quantities import N_E, N_Q

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
class ShellModel:
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
        if not np.any(self.measure.contract(np.zeros(N_Q), np.ones(N_E))):
            object.__setattr__(self, "discretisation", self.discretisation.linearised())
        object.__setattr__(self, "_dead", self._dead_contributions())

    def _built(self, shell: Discretisation, initial: np.ndarray) -> ModalElement:
        options, interpolation = (self.thickness_strain, self.membrane), shell.geometry.interpolation
        arcs = self.bending != BENDINGS[0]
        why = refusal(self.thickness_strain, interpolation, self.measure, two_faces=shell.wall is None) if arcs else ""
        if why:
            raise ValueError(why)
        if shell.wall is not None:
            if self.section != SECTIONS[0]:
                raise ValueError(f"section {self.section!r} is of two faces, and surfaces inside the wall have none")
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
        if not isinstance(shell.geometry, QuadGeometry):
            return element
        own = shell.stiffness(self.section)
        return QuadElement.on(shell.geometry, element, own, initial, self.thickness_strain)

    @property
    def powers(self) -> list[tuple[int, int]]:
        """(r1, r2) of the mode of each mode strain."""
        return self._element.powers

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
            shell.hangers.stiffen(tangent, v, shell.on_nodes(_less(force, self._loads(external))))
        return Linearisation(
            residual=internal - outside,
            tangent=shell.assemble(tangent),
            scale=float(max(norm(inside, check_finite=False), norm(outside, check_finite=False))),
            remember=lambda du: None if B is None else H + element.change(shell.geometry, _along(B, shell, du), slopes),
        )

    @property
    def quadratic(self) -> str | None:
        """None where the internal force is a polynomial of u and the load is dead; else what is not."""
        if not isinstance(self.measure, QuadraticMeasure):
            return f"measure {self.measure.name} is not quadratic in the displacements"
        if self.discretisation.hangers is not None:
            return "hanging nodes turn with the edges that carry them"
        if not isinstance(self._element, MixedElement) or isinstance(self._element, QuadElement | ArcElement):
            return "quadrilaterals, arcs and surfaces inside the wall have no series yet"
        if self.couples is not None or (self.pressure is not None and self.pressure.follower):
            return "the load follows the shell"
        return None

    def series(self, u: np.ndarray, order: int) -> ShellSeries:
        """The recurrence of power series at the free displacements u (n,); raises ValueError where it is none."""
        if self.quadratic is not None:
            raise ValueError(self.quadratic)
        shell = self.discretisation
        assert isinstance(self._element, MixedElement)
        return ShellSeries(shell, ElementSeries(self._element, shell.geometry, self._element_vectors(u), order))

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

    def _at(self, u: np.ndarray) -> Discretisation:
        return self.discretisation.at(self.displacements(u))

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

    def resultants(self, u: np.ndarray) -> np.ndarray:
        """Mode resultants H (E, 22) [N/mm], in the order of :data:`formulations.element.modes.MODES`.

        With surfaces inside the wall (E, 15 T), in that of :mod:`formulations.element.walls.modes`.
        """
        return self._element.resultants(self.mode_strains(u))

    def mode_strains(self, u: np.ndarray) -> np.ndarray:
        """Mode strains E (E, 22), or (E, 15 T) as :meth:`resultants`."""
        return self._element.mode_strains(self.discretisation.geometry, self._element_vectors(u))

    def gauss_strains(self, u: np.ndarray) -> np.ndarray:
        """Strains (E, 4, 11) of the modes at the Gauss points, in the axes of the laminate."""
        return self._element.at_gauss(self.discretisation.geometry, self.mode_strains(u))

    def strains_at(self, u: np.ndarray, xi: np.ndarray) -> np.ndarray:
        """Strains (E, p, 11) of the modes at points xi (p, 2) of the reference square: bilinear, as the modes are."""
        through_gauss, _ = shape_functions(np.sqrt(3.0) * xi)
        return np.einsum("pg,egi->epi", through_gauss, self.gauss_strains(u))

    def mean_strains(self, u: np.ndarray) -> np.ndarray:
        """Means E (E, 11) over the elements, in the axes of the laminate."""
        return self._element.mean_strains(self.discretisation.geometry, self.mode_strains(u))

    def mean_resultants(self, u: np.ndarray) -> np.ndarray:
        """Means H (E, 11) [N/mm] over the elements, in the axes of the laminate."""
        return self._element.mean_resultants(self.discretisation.geometry, self.mode_strains(u))

    def wall_stresses(self, u: np.ndarray, taken: np.ndarray) -> np.ndarray:
        """Mean S (E, plies, k, 6) [MPa]: 11, 22, 12, 13, 23, 33 along the coordinates, with surfaces inside the wall.

        taken (plies, k, T): the places, see :meth:`formulations.section.sampling.Sampling.taken`.
        """
        from formulations.element.walls.sampling_element import SamplingElement

        assert isinstance(self._element, SamplingElement)
        return self._element.stresses(self.mode_strains(u), taken)

    def ply_stresses(self, u: np.ndarray) -> np.ndarray:
        """Mean S_LL, S_TT, S_LT [MPa] along and across the fibres on both sides of each ply, (E, plies, 2, 3)."""
        shell = self.discretisation
        if shell.wall is None:
            return shell.stresses(self.mean_strains(u), self.section)
        sides = np.array([shell.wall.sampling.taken(k, np.array(d)) for k, d in enumerate(shell.wall.sampling.ends)])
        S = self.wall_stresses(u, sides)[..., :3]
        turns = [np.linalg.inv(strain_rotation(ply.angle)[PLANE, PLANE]) for ply in shell.laminate.plies]
        return np.einsum("epsi,pij->epsj", S, np.array(turns))

    def displacements(self, u: np.ndarray) -> np.ndarray:
        """All face displacements (N, 6), the prescribed ones included."""
        return self.discretisation.expand(u, self.prescribed)

    def nodal_displacements(self, u: np.ndarray) -> np.ndarray:
        """The same, (N, 6 and more): those of surfaces inside the wall follow those of the faces."""
        shell = self.discretisation
        if shell.wall is None:
            return self.displacements(u)
        faces, inside = np.split(shell.map.everywhere(u, self.prescribed), [shell.map.n_faces])
        return np.hstack([each.reshape(shell.grid.n_nodes, -1) for each in (faces, inside)])

    def reactions(self, u: np.ndarray) -> np.ndarray:
        """Forces (N, 6) of the supports on the shell in equilibrium at u [N], in the local frames; 0 where free.

        A hinge midway between the faces acts on both alike. Nodal forces put on a support itself are not counted.
        """
        force, external = self.element_forces(u)
        return self._reactions(self._at(u), _less(force, self._loads(external)))

    def _reactions(self, shell: Discretisation, total: np.ndarray) -> np.ndarray:
        nodal = shell.nodal(total)
        on_hinges = np.repeat(nodal.reshape(-1, 3, 2).mean(axis=2), 2, axis=1)
        return np.where(shell.map.held, nodal, np.where(shell.map.hinged, on_hinges, 0.0))

    def outside_force(self, u: np.ndarray) -> np.ndarray:
        """Resultant (3,) of loads and supports on the shell at u [N], Cartesian. Dead forces on a hinge do not count.

        In equilibrium with a foundation, its force + this = :meth:`spurious_force`.
        """
        return self._outside_and_spurious(u)[0]

    def spurious_force(self, u: np.ndarray) -> np.ndarray:
        """What the internal forces of all elements add up to (3,) [N], Cartesian.

        Nothing where the interpolation can translate the shell without strain: "isoparametric", or on a plate. Where
        components along a curved surface are interpolated it can not, and the sum falls with the square of the mesh.
        """
        return self._outside_and_spurious(u)[1]

    def left_to_foundation(self, u: np.ndarray) -> np.ndarray:
        """:meth:`outside_force` - :meth:`spurious_force`, (3,) [N]: what a foundation balances."""
        return np.subtract(*self._outside_and_spurious(u))

    def _outside_and_spurious(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        force, external = self.element_forces(u)
        loads, shell = self._loads(external), self._at(u)
        nodal = shell.nodal(loads) + self._reactions(shell, _less(force, loads))
        if self.forces is not None:
            nodal += np.where(self.discretisation.map.hinged, 0.0, self.discretisation.map.placed(self.forces))
        return self._resultant(nodal), self._resultant(shell.nodal(force))

    def _resultant(self, nodal: np.ndarray) -> np.ndarray:
        """Cartesian sum (3,) of forces (N, 6) in the local frames."""
        frame = self.discretisation.surface.frame(*self.discretisation.grid.nodes.T)
        return np.einsum("nif,nij->j", nodal.reshape(-1, 3, 2), frame)

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
        """Resultants (E, 22), external forces that follow (or None); the rest is written, see MixedElement."""
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

    def _loads(self, external: np.ndarray | None) -> np.ndarray:
        return self._dead if external is None else _less(self._dead, -external)

    def _dead_contributions(self) -> np.ndarray:
        """Element forces (E, 24) of dead pressure and of H0 on the linear strains."""
        geometry = self.discretisation.geometry
        constant = self._element.linear_initial_force(geometry, self.discretisation.dofs.shape[1])
        if self.pressure is not None and not self.pressure.follower:
            constant[:, :N_DOF] += self.pressure.dead_force(geometry)
        return constant

    def strain_change(self, u: np.ndarray, du: np.ndarray) -> np.ndarray:
        """B(u) du (E, 22): the change of the mode strains along the free displacements du, to first order."""
        B = self._element.mode_gradient(self.discretisation.geometry, self._element_vectors(u))
        return _along(B, self._at(u), du)

    def _element_vectors(self, u: np.ndarray) -> np.ndarray:
        return self.discretisation.of_elements(u, self.prescribed)


@dataclass(frozen=True, eq=False)
class ShellSeries:
    """What the orders of a power series of u leave to the next one, on the unknowns; see :mod:`element.series`."""

    discretisation: Discretisation
    elements: ElementSeries

    def add(self, du: np.ndarray) -> np.ndarray:
        """R_{k+1} (n,) [N] once u_k (n,) is known: called with k = 1, 2, ... in turn."""
        shell = self.discretisation
        return shell.gather(self.elements.add(shell.moved(du)))


def _less(force: np.ndarray, loads: np.ndarray) -> np.ndarray:
    """Forces on elements without loads, which may be of their faces alone, (E, 24)."""
    if force.shape == loads.shape:
        return np.asarray(force - loads)
    left = force.copy()
    left[:, : loads.shape[1]] -= loads
    return left


def _symmetric(D: np.ndarray) -> bool:
    return bool(np.max(np.abs(D - D.swapaxes(-1, -2))) <= 1e-12 * np.max(np.abs(D)))


def _along(B: np.ndarray, shell: Discretisation, du: np.ndarray) -> np.ndarray:
    """B dv (E, 22) of the displacements that the free ones du bring."""
    return np.matmul(B, shell.moved(du)[..., None])[..., 0]
