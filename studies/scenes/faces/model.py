"""The path of a scene whose faces meet, the settings that such scenes share, and what is read off their states.

Bodies are in :mod:`studies.scenes.faces.bodies`.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import numpy as np

from contact.faces.pair import Pair
from contact.faces.sampling import PAIRINGS, joined
from contact.faces.several import Several
from contact.problem import ContactProblem, ContactSolution
from formulations.conditions.boundary import FACES
from formulations.shell import ShellModel
from studies.ask.layers import write_layers
from studies.ask.request import Request, Value
from studies.ask.scene import Begun, Observation, Setting, Stage
from studies.scenes.faces.bodies import Bodies, Body, Pairing, Placed, Side

PAIRING = Setting.one_of("pairing", PAIRINGS, "mortar", "gaps of the nodes of the slave, or averaged gaps")
SHAPES = ("facets", "curved")
SHAPE_OF_FACES = Setting.one_of(
    "faces", SHAPES, SHAPES[0], "shape of the patches: flat, or curved by the normals at their corners"
)
TOUCHING = 1e-9  # of the size of faces: a smaller gap at rest counts as closed
SLAVES = ("first", "second")
SLAVE = Setting.one_of("slave", SLAVES, SLAVES[0], "slave body, whose face has the candidates; the other is the master")
OTHER = Setting(
    "other_elements",
    75,
    "elements along a line of the second body, per cent of those of the first",
    "int",
    low=10,
    high=1000,
    unit="%",
)
DRAG = Setting("drag_mm", None, "positions of the first body along the second, in turn", "path", otherwise="none")
PAIRED = (OTHER, PAIRING, SHAPE_OF_FACES, SLAVE)


def paired(**defaults: Value) -> tuple[Setting, ...]:
    """The settings of two bodies that meet, with defaults of a scene's own by their keys."""
    return tuple(replace(each, default=defaults.get(each.key, each.default)) for each in PAIRED)


def uncut(request: Request) -> Request:
    """Without leaves: cuts of one body do not apply to the other, all follow the mesh."""
    return replace(request, leaves=())


def of_second(count: int, request: Request) -> int:
    """Elements along a line of the second body, where the first has ``count``."""
    return max(1, round(count * request.number("other_elements") / 100))


@dataclass(frozen=True, eq=False)
class Facing:
    """Two sides that may meet; nodes (m,): points of the slave's face, the candidates.

    smooth: whether there is no friction between them, whatever there is between others.
    alike (m, j): all points of that face that move as a candidate does, which stands for them; it comes first.
    """

    slave: Side
    master: Side
    nodes: np.ndarray
    smooth: bool = False
    alike: np.ndarray | None = None

    @classmethod
    def between(cls, request: Request, first: tuple[Side, np.ndarray], second: tuple[Side, np.ndarray]) -> Self:
        """The side requested is the slave; with each its points (m,), or (m, j) where j move alike."""
        slave_index = SLAVES.index(request.choice(SLAVE.key))
        (slave, points), (master, _) = (first, second)[slave_index], (first, second)[1 - slave_index]
        return cls(slave, master, points) if points.ndim == 1 else cls(slave, master, points[:, 0], alike=points)

    @property
    def said(self) -> str:
        """Which faces."""
        slave, master = (f"the {FACES[side.face]} face of body {side.body + 1}" for side in (self.slave, self.master))
        return f"{slave} against {master}"

    @property
    def whole(self) -> np.ndarray:
        """The points (m, j) that each candidate stands for."""
        return self.nodes[:, None] if self.alike is None else self.alike

    def points(self, bodies: Sequence[Body]) -> np.ndarray:
        """Those (m, j) among the points that a file has of the slave."""
        return bodies[self.slave.body].points_of(self.slave.face)[self.whole]

    def at_rest(self, bodies: Bodies, pairing: Pairing) -> Pair:
        """The pair of bodies that are at rest."""
        pair = bodies.pair(self.slave, self.master, self.whole.ravel(), pairing)
        return pair if self.alike is None else replace(pair, sampling=joined(pair.sampling, self.alike.shape[1]))


@dataclass(frozen=True, eq=False)
class Meeting:
    """What a scene may read off a state u (n,): by candidate, at the positions (m, 3) [mm] of their nodes.

    pair (m,): the number of theirs.  force (m,) [N], pressure (m,) [MPa], area (m,) [mm^2].
    pairs: those themselves.
    """

    u: np.ndarray
    pair: np.ndarray
    position: np.ndarray
    force: np.ndarray
    pressure: np.ndarray
    area: np.ndarray
    pairs: tuple[Pair, ...]

    @cached_property
    def resultant(self) -> np.ndarray:
        """(pairs, 3) [N] of each pair on its slave; the sum of its forces where all have one direction."""
        each = [pair.resultant(self.u, self.force[self.pair == number]) for number, pair in enumerate(self.pairs)]
        return np.array(each)


@dataclass(frozen=True, eq=False)
class FacesModel:
    """One path of the parameter ``key``, from rest.

    bodies_at(t): all bodies where they are.  pairs: what may touch.  measure_at(t, meeting): what is read, {name_unit:
    value}.
    dragged_at(d): all bodies after the path, one of them dragged along the other by d, with stops at ``drags`` [mm].
    lying: what is before the other face touches it without pressure at rest.
    shown: where its fields are, at the last target unless given.
    before (n,): the state at the start of the path, at rest unless given.
    """

    bodies_at: Callable[[float], Bodies]
    pairs: tuple[Facing, ...]
    pairing: Pairing
    targets: Sequence[float]
    measure_at: Callable[[float, Meeting], Mapping[str, float]]
    key: str
    lying: bool = False
    shown: float | None = None
    dragged_at: Callable[[float], Bodies] | None = None
    drags: Sequence[float] = ()
    before: np.ndarray | None = None

    @classmethod
    def of(
        cls,
        request: Request,
        bodies_at: Callable[[float], Bodies],
        pairs: Sequence[Facing],
        measure_at: Callable[[float, Meeting], Mapping[str, float]],
        key: str = "delta_mm",
        **more: Any,
    ) -> Self:
        """The targets are those asked for of the key, and so is the pairing."""
        pairing = Pairing(request.choice(PAIRING.key), request.choice(SHAPE_OF_FACES.key) == SHAPES[1])
        targets = more.pop("targets", None) or request.numbers(key)
        return cls(bodies_at, tuple(pairs), pairing, targets, measure_at, key, **more)

    @cached_property
    def shell(self) -> ShellModel:
        """The first body that is a shell; raises AttributeError without one, as for an attribute that is missing."""
        for each in self.bodies_at(self.targets[-1]).parts:
            if isinstance(each, Placed):
                return each.shell
        raise AttributeError("no body is a shell")

    @property
    def said(self) -> str:
        """Which faces meet, and how."""
        return f"{'; '.join(each.said for each in self.pairs)}, {self.pairing.name}"

    @cached_property
    def pair_of_candidate(self) -> np.ndarray:
        """The number of the pair of each candidate (m,)."""
        return np.repeat(np.arange(len(self.pairs)), [len(each.nodes) for each in self.pairs])

    @cached_property
    def n_unknowns(self) -> int:
        """Number of unknowns."""
        return int(self.bodies_at(0.0).starts[-1])

    def stages(self) -> Iterator[Stage]:
        """The path from rest."""
        yield Stage("load", self._begin, tuple(self.targets), self._observe)
        if self.drags:
            yield Stage("drag", self._slid._begin, tuple(self.drags), self._slid._slides)

    @cached_property
    def _slid(self) -> Self:
        """The model of its drag."""
        assert self.dragged_at is not None
        end = self.targets[-1]
        return replace(
            self,
            bodies_at=self.dragged_at,
            targets=self.drags,
            key=DRAG.key,
            measure_at=lambda d, meeting: self.measure_at(end, meeting),
            drags=(),
        )

    def _slides(self, problem: ContactProblem, state: ContactSolution, d: float) -> Observation:
        """The headline is that of the end of the press."""
        return replace(self._observe(problem, state, d), quantities={})

    def _begin(self, previous: ContactSolution | None) -> Begun:
        if previous is not None:
            return self.problem_at, previous
        rest = ContactSolution.at_rest(self.n_unknowns, len(self.pair_of_candidate))
        if self.before is not None:
            rest = replace(rest, u=self.before)
        if not self.lying:
            return self.problem_at, rest
        touching = [pair.at(rest.u).gap <= TOUCHING * pair.size for pair in self.pairs_at(0.0)]
        return self.problem_at, replace(rest, active=np.concatenate(touching))

    @cached_property
    def _at_rest(self) -> tuple[Pair, ...]:
        """They define where the slaves are sampled along the path, and how curved faces are joined."""
        bodies = self.bodies_at(0.0)
        return tuple(each.at_rest(bodies, self.pairing) for each in self.pairs)

    def pairs_at(self, t: float) -> tuple[Pair, ...]:
        """The pairs at a point of the path."""
        bodies, facings = self.bodies_at(t), zip(self.pairs, self._at_rest, strict=True)
        return tuple(
            replace(
                bodies.pair(each.slave, each.master, each.nodes, self.pairing, rest),
                smooth=each.smooth,
            )
            for each, rest in facings
        )

    def problem_at(self, t: float) -> ContactProblem:
        """All bodies and their pairs at a point of the path."""
        pairs = self.pairs_at(t)
        return self.bodies_at(t).against(pairs[0] if len(pairs) == 1 else Several(pairs))

    def _observe(self, problem: ContactProblem, state: ContactSolution, t: float) -> Observation:
        pairs, which = self.pairs_at(t), self.pair_of_candidate
        facings = zip(pairs, self.pairs, strict=True)
        position = np.concatenate([pair.positions(state.u)[each.nodes] for pair, each in facings])
        forces, pressure = problem.nodal_forces(state.pressure), state.pressure
        meeting = Meeting(state.u, which, position, forces, pressure, problem.weights, pairs)
        quantities = dict(self.measure_at(t, meeting))
        return Observation({self.key: t, **quantities, "contact_nodes": int(state.active.sum())}, quantities)

    def moved(self, t: float) -> Self:
        """With its bodies where they are at t."""
        return replace(self._slid if self.drags else self, shown=t)

    @property
    def candidate_of_point(self) -> tuple[np.ndarray, np.ndarray]:
        """The candidate of each point of its file, -1 for none, and the node of its body that it is, (P,) each."""
        bodies = self.bodies_at(0.0).parts
        candidates, start = [np.full(len(each.nodes), -1) for each in bodies], 0
        for each in self.pairs:
            candidates[each.slave.body][each.points(bodies)] = start + np.arange(len(each.nodes))[:, None]
            start += len(each.nodes)
        return np.concatenate(candidates), np.concatenate([each.nodes for each in bodies])

    def write_fields(self, path: Path, state: ContactSolution) -> None:
        """All bodies where they are shown, with the contact pressures on the faces that are slaves."""
        bodies = self.bodies_at(self.targets[-1] if self.shown is None else self.shown)
        pressures = [np.zeros(len(each.nodes)) for each in bodies.parts]
        for number, each in enumerate(self.pairs if len(state.pressure) else ()):
            on_pair = state.pressure[self.pair_of_candidate == number]
            pressures[each.slave.body][each.points(bodies.parts)] = on_pair[:, None]
        layers = zip(bodies.parts, bodies.split(state.u), pressures, strict=True)
        write_layers(path, [part.layer(u, pressure) for part, u, pressure in layers if len(part.nodes)])
