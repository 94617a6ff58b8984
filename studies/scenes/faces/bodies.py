"""Bodies whose faces meet: the interface of a body, all of them as one system, and the pair that two faces make.

A body has a frame of its own, which is turned and shifted in space: one that is carried towards another one is the same
body with another shift. Points and patches of a face are its own, and positions are linear in the unknowns. Solids are
in :mod:`studies.scenes.faces.solids`; what a gap is does not enter here, see :mod:`contact.faces.pair`.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy import sparse

from contact.faces.bulges import Bulges
from contact.faces.pair import Pair, between
from contact.faces.sampling import at_nodes, mortar
from contact.faces.several import Several
from contact.faces.symmetry import motions
from contact.problem import ContactProblem, Linearisation, Linearised
from formulations.conditions.boundary import FACES
from formulations.shell import ShellModel
from studies.ask.layers import Layer, shell_layer


class Body(Protocol):
    """A loaded body in space with n unknowns; a face is given by its number, 0 inner or 1 outer."""

    @property
    def n_free(self) -> int:
        """Number of unknowns n."""

    @property
    def conservative(self) -> bool:
        """Whether :meth:`energy` is the potential of the residual."""

    def linearise(self, u: np.ndarray, memory: object = None) -> Linearised:
        """Residual [N] and tangent [N/mm] at u (n,)."""

    def residual(self, u: np.ndarray) -> np.ndarray:
        """That of :meth:`linearise` alone (n,)."""

    def energy(self, u: np.ndarray) -> float:
        """Potential [N mm]."""

    def face(self, face: int) -> tuple[np.ndarray, sparse.csr_matrix, np.ndarray]:
        """Points (k, 3) at rest [mm], their displacements (3k, n), and bilinear patches (F, 4) turned outwards."""

    def held(self, face: int) -> list[sparse.csr_matrix]:
        """Displacements (3k, n) of which all are held across a plane of symmetry at a point (k,) of a face."""

    def areas(self, face: int) -> np.ndarray:
        """Shares (k,) [mm^2] of the points in the area of a face."""

    def points_of(self, face: int) -> np.ndarray:
        """Where the points of a face (k,) are among those of :meth:`layer`."""

    @property
    def nodes(self) -> np.ndarray:
        """Which node of its mesh each point of :meth:`layer` is."""

    def layer(self, u: np.ndarray, pressure: np.ndarray) -> Layer:
        """What a file has of it, with the pressure (P,) [MPa] at its points."""


@dataclass(frozen=True, eq=False)
class Placed:
    """A shell in space: x = turn X + shift with its own coordinates X; turn (3, 3), shift (3,) [mm]."""

    shell: ShellModel
    turn: np.ndarray = field(default_factory=lambda: np.eye(3))
    shift: np.ndarray = field(default_factory=lambda: np.zeros(3))

    @property
    def n_free(self) -> int:
        """Number of unknowns."""
        return self.shell.discretisation.n_free

    @property
    def conservative(self) -> bool:
        """Whether :meth:`energy` is the potential of the residual."""
        return self.shell.conservative

    def linearise(self, u: np.ndarray, memory: object = None) -> Linearised:
        """Residual and tangent at u (n,)."""
        return self.shell.linearise(u, memory)

    def residual(self, u: np.ndarray) -> np.ndarray:
        """That of :meth:`linearise` alone."""
        return self.shell.residual(u)

    def energy(self, u: np.ndarray) -> float:
        """Potential [N mm]."""
        return self.shell.energy(u)

    def face(self, face: int) -> tuple[np.ndarray, sparse.csr_matrix, np.ndarray]:
        """Positions (N, 3) at rest, displacements (3N, n), and patches (E, 4) turned outwards: 0 inner, 1 outer."""
        body = self.shell.discretisation
        every, quads = np.arange(body.grid.n_nodes), body.grid.elements
        whole = sparse.kron(sparse.eye_array(len(every)), self.turn, format="csr")
        inwards = body.left_handed() != (face == 0)
        place = body.positions()[face] @ self.turn.T + self.shift
        operator = sparse.csr_matrix(whole @ body.displacement_operator(every, face))
        return place, operator, np.where(inwards[:, None], quads[:, ::-1], quads)

    def held(self, face: int) -> list[sparse.csr_matrix]:
        """Those of both faces."""
        return [self.face(each)[1] for each in (face, 1 - face)]

    def areas(self, face: int) -> np.ndarray:
        """Shares (N,) [mm^2] of the points in the area of a face."""
        return self.shell.discretisation.nodal_areas(FACES[face])

    def points_of(self, face: int) -> np.ndarray:
        """Where the points of a face (N,) are among those of :meth:`layer`."""
        n = self.shell.discretisation.grid.n_nodes
        return np.arange(n) + face * n

    @property
    def nodes(self) -> np.ndarray:
        """Which node of the grid each point of :meth:`layer` is."""
        return np.tile(np.arange(self.shell.discretisation.grid.n_nodes), 2)

    def layer(self, u: np.ndarray, pressure: np.ndarray) -> Layer:
        """What a file has of it, with the pressure (2N,) [MPa] on both faces."""
        return shell_layer(self.shell, u, pressure).placed(self.turn, self.shift)


@dataclass(frozen=True, eq=False)
class Side:
    """A body by its number, its face, 0 inner or 1 outer, and its elements (k,) that may meet, all unless given."""

    body: int
    face: int
    patches: slice | np.ndarray = field(default_factory=lambda: slice(None))


@dataclass(frozen=True)
class Pairing:
    """name: of :data:`contact.faces.sampling.PAIRINGS`.  curved: whether faces are between their points, or facets."""

    name: str
    curved: bool


@dataclass(frozen=True, eq=False)
class Bodies:
    """All bodies as one system: the unknowns one body after the other."""

    parts: tuple[Body, ...]

    @cached_property
    def starts(self) -> np.ndarray:
        """Where the unknowns of each begin, and the number of all (bodies + 1,)."""
        return np.append(0, np.cumsum([each.n_free for each in self.parts]))

    def split(self, u: np.ndarray) -> list[np.ndarray]:
        """The unknowns of each."""
        return np.split(u, self.starts[1:-1])

    def linearise(self, u: np.ndarray, memory: object = None) -> Linearisation:
        """Residual, tangent and scale of all; the memory is a list of theirs."""
        memories = memory if isinstance(memory, list) else [None] * len(self.parts)
        each = zip(self.parts, self.split(u), memories, strict=True)
        lins = [part.linearise(u_part, known) for part, u_part, known in each]
        return Linearisation(
            np.concatenate([lin.residual for lin in lins]),
            sparse.csc_matrix(sparse.block_diag([lin.tangent for lin in lins], format="csc")),
            max(lin.scale for lin in lins),
            lambda du: [lin.remember(u_part) for lin, u_part in zip(lins, self.split(du), strict=True)],
        )

    def residual(self, u: np.ndarray) -> np.ndarray:
        """That of :meth:`linearise` alone."""
        return np.concatenate([part.residual(u_part) for part, u_part in zip(self.parts, self.split(u), strict=True)])

    def energy(self, u: np.ndarray) -> float:
        """The sum of all [N mm]."""
        return sum(part.energy(u_part) for part, u_part in zip(self.parts, self.split(u), strict=True))

    def volume_ratios(self, u: np.ndarray) -> np.ndarray:
        """Those of the elements of all shells whose strains are finite."""
        each = zip(self.parts, self.split(u), strict=True)
        shells = [(part.shell, own) for part, own in each if isinstance(part, Placed) and not part.shell.linear]
        return np.concatenate([np.empty(0), *(shell.volume_ratios(own) for shell, own in shells)])

    def pair(self, slave: Side, master: Side, nodes: np.ndarray, pairing: Pairing, rest: Pair | None = None) -> Pair:
        """What two sides make with each other, of two bodies or of one; nodes (m,): of the slave that may touch.

        rest: the pair at rest, which defines where the slave is sampled; by default the bodies are at rest.
        """
        faces = [(self.parts[side.body].face(side.face), side.body) for side in (slave, master)]
        (x, moves, quads), _ = faces[0]
        (x_other, others, master_quads), _ = faces[1]
        reference, n = np.vstack([x, x_other]), int(self.starts[-1])
        columns = [sparse.csr_matrix((each.shape[0], n)) for each in (moves, others)]
        placed = [
            sparse.hstack([columns[k][:, : self.starts[body]], each, columns[k][:, self.starts[body + 1] :]])
            for k, (each, body) in enumerate(((moves, slave.body), (others, master.body)))
        ]
        operator, master_quads = sparse.csr_matrix(sparse.vstack(placed)), master_quads[master.patches] + len(x)
        slave_quads = quads[slave.patches]
        if rest is not None:
            return Pair(reference, operator, master_quads, rest.sampling, slave_quads, bulges=rest.bulges)
        if pairing.name == "nodes":
            sampling = at_nodes(nodes, len(reference), self.parts[slave.body].areas(slave.face)[nodes])
        else:
            sampling = mortar(reference, slave_quads, master_quads, nodes)
        pair = Pair(reference, operator, master_quads, sampling, slave_quads)
        if not pairing.curved:
            return pair
        free = np.concatenate([sum(map(motions, self.parts[side.body].held(side.face))) for side in (slave, master)])
        return replace(pair, bulges=Bulges.of(reference, np.concatenate([slave_quads, master_quads]), free))

    def against(self, pair: Pair | Several) -> ContactProblem:
        """The contact problem of the pairs, with what the judge needs.

        The elimination orders of the bodies do not apply: a pair couples unknowns that either body has last or first.
        """
        problem = replace(between(self.linearise, pair), residual=self.residual, volume_ratios=self.volume_ratios)
        return replace(problem, energy=self.energy) if all(each.conservative for each in self.parts) else problem
