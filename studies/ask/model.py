"""The model that a scene builds for one request, and the stages of it which a solve walks through.

How stages are solved does not enter here; what a scene declares is :mod:`studies.ask.declarations`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, Self, runtime_checkable

import numpy as np

from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution
from formulations.shell import ShellModel
from studies.ask.layers import write_fields
from studies.output.atomic import Table

if TYPE_CHECKING:  # loaded with a scene that traces a curve
    from contact.continuation.arc_length import ArcLength, Trace
    from contact.continuation.equilibrium_curve import ArcPoint
    from contact.continuation.series_path import PowerSeries


@dataclass(frozen=True, eq=False)
class Observation:
    """What a scene reads off a converged state: an entry of ``steps`` (or None), headline values, rows of tables.

    said: of a mode, for people.
    tables: made on request alone, for they take longer than the values.
    """

    step: dict[str, Any] | None
    quantities: dict[str, float] = field(default_factory=dict)
    tables: Callable[[], dict[str, Table]] = dict
    said: str = ""


Begun = tuple[Callable[[float], ContactProblem], ContactSolution]  # problem_at(t), and the solution to start from


@dataclass(frozen=True)
class Units:
    """Those of a problem: how many of its lengths are a mm, and of its stresses a MPa."""

    length: float = 1.0
    stress: float = 1.0

    @property
    def force(self) -> float:
        """How many of its forces are a N."""
        return self.stress * self.length**2


@dataclass(frozen=True, eq=False)
class Stage:
    """One path of problems.

    begin(previous) -> (problem_at(t), starting solution); targets: the values of t to report, the path starts at 0;
    observe(problem, state, t) -> Observation.  whole(u): the unknowns of the model from those of the stage, when it
    solves a smaller problem on the way.  see_mode(state, mode): what is seen of a mode (n,) at the end of the path.
    units: of the problem; what is observed is in mm, MPa and N.  rubs(t): the share in [0, 1] of the coefficient of
    friction that acts at t.
    """

    name: str
    begin: Callable[[ContactSolution | None], Begun]
    targets: Sequence[float]
    observe: Callable[[ContactProblem, ContactSolution, float], Observation]
    whole: Callable[[np.ndarray], np.ndarray] | None = field(default=None, kw_only=True)
    see_mode: Callable[[ContactSolution, np.ndarray], Observation] | None = field(default=None, kw_only=True)
    units: Units = field(default=Units(), kw_only=True)
    rubs: Callable[[float], float] = field(default=lambda t: 1.0, kw_only=True)

    def lifted(self, solution: ContactSolution) -> ContactSolution:
        """The solution in the unknowns of the model."""
        return solution if self.whole is None else replace(solution, u=self.whole(solution.u))


@dataclass(frozen=True, eq=False)
class CurveStage(Stage, ABC):
    """A path traced through limit points, by arc length or by power series, until its last target is first reached.

    summarise(points): headline values of the whole curve; ``observe`` sees every point of it.
    """

    continuation: ArcLength | PowerSeries
    summarise: Callable[[Sequence[ArcPoint]], dict[str, float]]

    @abstractmethod
    def trace(self, begun: Begun, algorithm: ContactAlgorithm, tell: Callable[[float], None]) -> Trace:
        """The curve from where the stage begins; its first point is that."""


class SceneModel(Protocol):
    """A scene built for one request."""

    @property
    def n_unknowns(self) -> int:
        """Number of unknowns."""

    def stages(self) -> Iterator[Stage]:
        """The paths to follow, in order."""

    def write_fields(self, path: Path, state: ContactSolution) -> None:
        """Write the fields of a state for ParaView and its like."""


@runtime_checkable
class MovingModel(SceneModel, Protocol):
    """A model whose supports or bodies are elsewhere at every parameter of its last stage."""

    def moved(self, t: float) -> Self:
        """With them where they are at t."""


@runtime_checkable
class PointedModel(SceneModel, Protocol):
    """A model that says itself what the points of its file are."""

    @property
    def candidate_of_point(self) -> tuple[np.ndarray, np.ndarray]:
        """The candidate of each point, -1 for none, and the node of its body that it is, (P,) each."""


def candidates_at(nodes: np.ndarray, n: int) -> np.ndarray:
    """(n,) the contact candidate that each of n nodes is, -1 for none.  nodes: of the candidates."""
    candidate = np.full(n, -1)
    candidate[nodes] = np.arange(len(nodes))
    return candidate


def nodal_pressure(solution: ContactSolution, candidate: np.ndarray) -> np.ndarray:
    """Contact pressure at nodes that are these candidates (-1: none); zero before the first state with any."""
    if not len(solution.pressure):
        return np.zeros(len(candidate))
    return np.append(solution.pressure, 0.0)[candidate]


class ShellSceneModel:
    """What the models of all shell scenes share."""

    shell: ShellModel

    @property
    def n_unknowns(self) -> int:
        """Number of unknowns."""
        return self.shell.discretisation.n_free

    @property
    def candidate_of_node(self) -> np.ndarray:
        """(N,) the contact candidate that each node of the grid is or mirrors, -1 for none."""
        return np.full(self.shell.discretisation.grid.n_nodes, -1)

    @property
    def touching_face(self) -> int:
        """0 or 1: the inner or the outer face, at which candidates are."""
        return 1

    def outer_pressure(self, solution: ContactSolution) -> np.ndarray:
        """Contact pressure (N,) at the grid's nodes; zero where nothing is touched, and before the first contact."""
        return self.shell.discretisation.grid.carried(nodal_pressure(solution, self.candidate_of_node))

    def moved(self, t: float) -> Self:
        """With its supports where they are at the parameter t of its last stage."""
        return self

    def write_fields(self, path: Path, state: ContactSolution) -> None:
        """One layer of hexahedra between the two faces."""
        write_fields(path, self.shell, state.u, self.outer_pressure(state))


def moved(model: SceneModel, t: float) -> SceneModel:
    """The model whose fields are those at the parameter t of its last stage."""
    return model.moved(t) if isinstance(model, MovingModel) else model
