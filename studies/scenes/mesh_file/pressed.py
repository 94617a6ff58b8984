"""A deck pressed on a rigid foundation: where this stands, which face touches, the loads of the deck, then the travel.

The foundation stands at the first touch of the shell at rest. The loads of the deck grow first, beside it; then it
travels against ``towards``. The face on its side may touch, at every node that can move.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from contact.obstacles.foundation import Foundation
from contact.problem import ContactProblem, ContactSolution
from formulations.discretisation import Discretisation
from formulations.shell import ShellModel
from studies.ask.request import Request, Settings, UsageError
from studies.ask.scene import EPSILON, Observation, Setting, ShellSceneModel, Stage
from studies.scenes import foundations
from studies.scenes.contact.base import OUTER, ContactModel, Touch

Seen = Callable[[ShellModel, np.ndarray, float], dict[str, float]]
NONE = "none"
KEY = "foundation"
AXES = (1, 2, 3)
STEEP = 0.8  # cosine of an axis with the direction, above which a drum does not lie along it
ADVANCES = 500  # of a foundation towards its first touch, each by the smallest gap
TOUCHED = 1e-12  # of the size of the shell: a smaller gap counts as closed

BESIDE = Setting.one_of(KEY, (NONE, *foundations.PARAMETERS), NONE, "rigid obstacle that the shell is pressed on")
SETTINGS = (
    replace(BESIDE, default="plane"),
    *(each for each in foundations.SETTINGS if each.key != KEY),
    *(
        Setting(
            f"towards_{i}",
            float(i == 3),
            f"of the direction from the shell to the foundation, axis {i}",
            low=-1,
            high=1,
        )
        for i in AXES
    ),
    Setting("delta_mm", None, "travel of the foundation from first touch", "floats", 0, 1e6, otherwise="no travel"),
    Setting(
        "over_node",
        None,
        "node that a round foundation or a cleat stands over",
        "int",
        1,
        2**31 - 1,
        otherwise="foremost",
    ),
    Setting("along_deg", 0.0, "of a drum or a cleat, around towards, from the first axis across", low=-360, high=360),
    EPSILON,
)
QUANTITIES = {
    "force_N": "of the shell on the foundation, along towards",
    "peak_MPa": "largest contact pressure at a node",
}


def direction(settings: Settings) -> np.ndarray:
    """The unit vector from the shell to the foundation; raises UsageError for a zero vector."""
    towards = np.array([settings.number(f"towards_{i}") for i in AXES])
    length = float(np.linalg.norm(towards))
    if length == 0:
        raise UsageError("towards_1, towards_2 and towards_3 are all 0: one must not be")
    return np.asarray(towards / length)


def placed(request: Request, x: np.ndarray, over: np.ndarray | None) -> Foundation:
    """At the first touch of a face, points x (N, 3); raises UsageError where it misses the face.

    over (3,): the point that it stands over, by default the foremost, of several the one nearest to their mean.
    """
    towards = direction(request.settings)
    height = x @ towards
    size = float(np.ptp(x, axis=0).max())
    if over is None:
        foremost = x[height >= height.max() - 1e-6 * size]
        over = foremost[np.argmin(np.linalg.norm(foremost - foremost.mean(axis=0), axis=1))]
    axis = np.eye(3)[int(np.argmax(np.abs(towards) < STEEP))]
    first = axis - (axis @ towards) * towards
    first /= np.linalg.norm(first)
    angle = math.radians(request.number("along_deg"))
    along = math.cos(angle) * first + math.sin(angle) * np.cross(towards, first)
    rigid = foundations.foundation(request.settings, towards, along, np.cross(towards, along))
    at = over + (height.max() - over @ towards + size) * towards
    for _ in range(ADVANCES):
        gap = float(rigid.moved(at).gap(x).min())
        if gap <= TOUCHED * size:
            return rigid.moved(at)
        if at @ towards < height.min() - size:
            break
        at = at - gap * towards
    raise UsageError(f"a {request.choice(KEY)} over {over} does not come to touch the shell")


def touching_face(x: np.ndarray, normals: np.ndarray, towards: np.ndarray) -> int:
    """The face on the side of the foundation, by the normals (N, 3) of the foremost of the points x (N, 3)."""
    front = int(np.argmax(x @ towards))
    return OUTER if normals[front] @ towards > 0 else 0


def unmoved(discretisation: Discretisation) -> np.ndarray:
    """Nodes (k,) at which every component is held, at a face or midway between both."""
    dof_map = discretisation.map
    return np.flatnonzero(np.all(dof_map.held | dof_map.hinged, axis=1))


@dataclass(frozen=True, eq=False)
class PressedModel(ShellSceneModel):
    """The paths of ``parts`` one after the other; what is asked for is seen on the last."""

    shell: ShellModel
    parts: Sequence[ContactModel]

    def stages(self) -> Iterator[Stage]:
        """Under the name of what grows."""
        for part in self.parts:
            for stage in part.stages():
                yield replace(stage, name=part.key, observe=stage.observe if part is self.parts[-1] else _unseen)

    @property
    def touching_face(self) -> int:
        """That of the candidates."""
        return self.parts[-1].touching_face

    @property
    def candidate_of_node(self) -> np.ndarray:
        """(N,) the contact candidate that each node of the grid is, -1 for none."""
        return self.parts[-1].candidate_of_node

    def write_fields(self, path: Path, state: ContactSolution) -> None:
        """With the contact pressure on the face that touches."""
        self.parts[-1].write_fields(path, state)


def _unseen(problem: ContactProblem, state: ContactSolution, t: float) -> Observation:
    return Observation(None)


def pressed(request: Request, shell: ShellModel, face: int, foundation: Foundation, seen: Seen) -> PressedModel:
    """The shell under its loads, where it has any, then pressed as far as it is asked for.

    seen(shell, u, fraction): what is read of a state beside the foundation, under a fraction of the loads.
    Raises UsageError where it has none and nothing travels.
    """
    towards, held = direction(request.settings), unmoved(shell.discretisation)
    loads = shell.forces is not None or shell.pressure is not None
    fractions, parts = request.numbers("load_fraction") if loads else (), list[ContactModel]()

    def measured(fraction: float, at: Foundation, touch: Touch) -> dict[str, float]:
        x = touch.candidates.positions(touch.u)
        force = 0.0 - float(touch.force @ (at.gradient(x) @ towards))
        return {"force_N": force, "peak_MPa": float(np.max(touch.pressure)), **seen(shell, touch.u, fraction)}

    def part(key: str, targets: Sequence[float], way: float, body_at: Callable[[float], ShellModel]) -> ContactModel:
        def at(t: float) -> Foundation:
            return foundation.moved(-way * t * towards)

        def read(t: float, touch: Touch) -> dict[str, float]:
            return measured(last if way else t, at(t), touch)

        return ContactModel(shell, held, targets, at, read, key, body_at, face=face)

    last = fractions[-1] if fractions else 1.0
    if fractions:
        parts.append(part("load_fraction", fractions, 0.0, shell.scaled))
    if "delta_mm" in request.settings:
        body = shell.scaled(last)
        parts.append(part("delta_mm", request.numbers("delta_mm"), 1.0, lambda t: body))
    if not parts:
        raise UsageError("a foundation without delta_mm presses a shell without loads nowhere: give --set delta_mm=1")
    return PressedModel(shell, parts)
