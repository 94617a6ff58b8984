"""A converged cell from its field alone: the problem at its last load, the judge's residuals, the scene's quantities.

The problem is built here, its load is that of the request, and stages before the last one are solved here again: the
field of a record is that of its last load. What is claimed does not enter here, but for the point of a traced curve.

A field is read as it was written for ParaView, by :mod:`studies.output.vtu`, array by array, none larger than the model
asks for, back into the unknowns of a model that is built here.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from contact.continuation.stability import stability
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Outcome
from contact.verify import Verdict, claim, gap_residuals, judge
from formulations.discretisation import Discretisation
from formulations.solid.body import SolidDiscretisation
from studies.ask.request import Request, UsageError
from studies.ask.scene import CurveStage, Observation, SceneModel, ShellSceneModel, Stage, candidates_at, moved
from studies.ask.settings import configured, rubbing
from studies.gate.foreign import ClaimError
from studies.output.vtu import PackedArray, packed_arrays
from studies.scenes import SCENES
from studies.scenes.walk import walk

BEFORE = 1e-9  # of a large gap: where the foundation is that meets what was solved before, here and there
NOISE = 4 * float(np.finfo(float).eps)  # of the largest displacement: the last digits of a field
DERIVED = ("H_", "S_")  # how the names of resultants and of stresses begin
SAME = 1e-12  # of the largest value of an array: writing a field and reading it back
ALIKE = 1e-6  # of the largest of them: small differences of large displacements

Arrays = Mapping[str, np.ndarray]


def as_written(model: SceneModel, state: ContactSolution) -> tuple[bytes, Arrays]:
    """The file that the model writes of a state, and its arrays."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fields.vtu"
        model.write_fields(path, state)
        text = path.read_bytes()
    return text, {name: packed.values.ravel() for name, packed in packed_arrays(text).items()}


def arrays_of(text: bytes, expected: Arrays) -> dict[str, np.ndarray]:
    """The arrays by name, each with the type and as many values as in ``expected``; raises ClaimError."""
    there = packed_arrays(text)
    if there.keys() != expected.keys():
        raise ClaimError("field", f"has the arrays {', '.join(there) or 'of nothing'}, not {', '.join(expected)}")
    return {name: _unpacked(there[name], expected[name], name) for name in expected}


def _unpacked(packed: PackedArray, expected: np.ndarray, name: str) -> np.ndarray:
    """One array (k,), unpacked no further than expected: what says that it is small may be huge."""
    most = expected.nbytes
    try:
        data = packed.unpacked(most + 1)
    except ValueError as error:
        raise ClaimError("field", f"{name} cannot be unpacked: {error}") from None
    if len(data) != most or expected.dtype != packed.dtype:
        has = f"more than {most}" if len(data) > most else str(len(data))
        raise ClaimError("field", f"{name} has {has} bytes, {most} belong to this mesh")
    return np.frombuffer(data, packed.dtype)


def state_of(model: SceneModel, arrays: Arrays, m: int) -> ContactSolution:
    """The state with m candidates whose field this is; raises ClaimError for a field that the model cannot have.

    The unknowns are read off the nodes that own them. The field that they give must be this one: with supports, images,
    hanging nodes, points, candidates and resultants.
    """
    for name, values in arrays.items():
        if not np.all(np.isfinite(values)):
            raise ClaimError("field", f"{name} has {int(np.sum(~np.isfinite(values)))} values that are no numbers")
    body, nodes = _body(model)
    if isinstance(body, Discretisation) and body.wall is not None:
        raise ClaimError("field", "is of both faces alone, and the wall has surfaces between them")
    moved = arrays["displacement"].reshape(-1, 3)
    if isinstance(body, Discretisation):
        frame = body.surface.frame(*body.grid.nodes.T)
        faces = np.split(moved, 2)
        v = np.empty((len(frame), 6))
        for face in (0, 1):
            v[:, face::2] = np.einsum("nix,nx->ni", frame, faces[face])
        u, outer = body.map.restrict(v), np.split(arrays["pressure"], 2)[1]
    else:
        u, outer = moved.ravel()[body.free], arrays["pressure"]
    pressure = np.zeros(m)
    touching = np.flatnonzero(nodes >= 0) if m else np.zeros(0, int)
    pressure[nodes[touching]] = outer[touching]
    state = ContactSolution(u, pressure, pressure > 0, Outcome.CONVERGED)
    for name, ours in as_written(model, state)[1].items():
        _agree(name, arrays[name], ours, ALIKE if name.startswith(DERIVED) else SAME, arrays)
    return state


def _agree(name: str, claimed: np.ndarray, ours: np.ndarray, share: float, arrays: Arrays) -> None:
    alike = [each for each in arrays if each[:2] == name[:2]] if name.startswith(DERIVED) else [name]
    size = max(float(np.max(np.abs(arrays[each]), initial=0.0)) for each in alike)
    off = float(np.max(np.abs(claimed - ours), initial=0.0))
    if off > share * size:
        of = {"Points": "the mesh of the request", "displacement": "its supports", "pressure": "its candidates"}
        belongs = of.get(name, "its displacements")
        raise ClaimError("field", f"{name} differs by {off:.3g} from what belongs to {belongs}")


def _body(model: SceneModel) -> tuple[Discretisation | SolidDiscretisation, np.ndarray]:
    """What the unknowns are of, and the candidate of each node; raises ClaimError where no field can be read back."""
    if isinstance(model, ShellSceneModel):
        return model.shell.discretisation, model.candidate_of_node
    solid: Any = model
    body = getattr(getattr(solid, "body", None), "discretisation", None)
    if not isinstance(body, SolidDiscretisation):
        raise ClaimError("field", "of this scene cannot be read back")
    return body, candidates_at(solid.nodes, len(body.mesh.x))


@dataclass(frozen=True, eq=False)
class Recomputed:
    """What the field of a cell comes to at its last load.

    verdict, failures: of the judge, by the law and the tolerance of the request.  kkt: with the true gaps.
    gap_share: of a large gap that is none.  seen, shaken: what the scene reads of the field, and of the same with
    other last digits.
    """

    state: ContactSolution
    verdict: Verdict
    failures: list[str]
    kkt: Mapping[str, float]
    gap_share: float
    stable: str
    seen: Observation
    shaken: Observation


@dataclass(frozen=True, eq=False)
class Opened:
    """The model of a request and its last stage, begun from what the stages before it have come to here.

    first: whether there are none.  before: their headline quantities, and how many steps they recorded.
    """

    request: Request
    model: SceneModel
    algorithm: ContactAlgorithm
    stage: Stage
    first: bool
    before: Mapping[str, float]
    recorded: int
    begun: Any

    @classmethod
    def of(cls, request: Request) -> Opened:
        """Build it, and solve all stages but the last; raises ClaimError where that is not possible."""
        if rubbing(request.settings):
            raise ClaimError("mu", "the path to a state with friction is not in its last field")
        try:
            model = SCENES[request.scene].build(request)
            algorithm = configured(request.contact, request.settings)
        except ValueError as error:  # a UsageError is one
            raise ClaimError("scene", str(error)) from None
        (*earlier, stage), previous, recorded = model.stages(), None, 0
        before: dict[str, float] = {}
        for visited in walk(earlier, algorithm, request.steps):
            if not visited.converged:
                raise ClaimError("outcome", f"the stage {visited.stage.name!r} does not converge here")
            observation = visited.stage.observe(visited.problem, visited.point.solution, visited.point.requested)
            before |= observation.quantities
            recorded += observation.step is not None
            previous = visited.state
        try:
            begun = stage.begin(previous)
        except UsageError as error:
            raise ClaimError("scene", str(error)) from None
        return cls(request, model, algorithm, stage, not earlier, before, recorded, begun)

    @property
    def curve(self) -> bool:
        """Whether the field is of the end of a curve by arc length, whose other points are not kept."""
        return isinstance(self.stage, CurveStage)

    def at(self, load: float, arrays: Arrays, touching: int | None) -> Recomputed:
        """Judge and read a field at a load of the last stage; raises ClaimError for one that the model cannot have.

        touching: how many nodes are claimed to be in contact; what has no pressure and no gap counts where that fits.
        """
        problem = self.begun[0](load)
        if self.curve:
            problem = replace(problem, energy=None)
        state = state_of(moved(self.model, load), arrays, len(problem.weights))
        epsilon, n = self.algorithm.epsilon, len(state.u)
        verdict = judge(problem, state.u, state.pressure, epsilon=epsilon)
        shares = {"penetration": BEFORE, "complementarity": BEFORE} if not self.first else {}
        bounds = claim(self.request.number("tolerance"), n) | shares
        read = partial(self._read, problem, load, verdict, touching)
        observation, used = read(state)
        return Recomputed(
            state=used,
            verdict=verdict,
            failures=verdict.failures(**bounds),
            kkt=verdict.kkt | gap_residuals(problem, state.u, state.pressure, np.inf),
            gap_share=shares.get("penetration", 0.0),
            stable=stability(problem, used, epsilon).word,
            seen=observation,
            shaken=read(_shaken(used))[0],
        )

    def _read(
        self, problem: ContactProblem, load: float, verdict: Verdict, touching: int | None, state: ContactSolution
    ) -> tuple[Observation, ContactSolution]:
        """What the scene reads, and the state with the contact set that it was read with."""
        pressed = state.pressure > 0
        near = pressed | (problem.gap(state.u) <= verdict.gap_bound(BEFORE))
        observations = []
        for active in (pressed, near):
            used = replace(state, active=active)
            try:
                observations.append((self.stage.observe(problem, used, load), used))
            except UsageError as error:
                raise ClaimError("scene", str(error)) from None
        fitting = (each for each in observations if (each[0].step or {}).get("contact_nodes") == touching)
        return next(fitting, observations[0])


def _shaken(state: ContactSolution) -> ContactSolution:
    """The same with other last digits, always the same ones."""
    random = np.random.default_rng(0)
    u = state.u + NOISE * float(np.max(np.abs(state.u), initial=0.0)) * random.choice([-1.0, 1.0], len(state.u))
    return replace(state, u=u)
