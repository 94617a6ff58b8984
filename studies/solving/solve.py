"""From a request to a result: build, follow the stages, judge and record what is reached.

Nothing here knows a particular scene; no picture is drawn here. What is recorded is :mod:`studies.solving.recording`.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from contact import operations as of_contact
from contact.continuation.candidates import Starts
from contact.problem import Outcome
from formulations import operations as of_elements
from studies.ask.model import SceneModel, Stage
from studies.ask.request import Request, UsageError
from studies.ask.scene import Scene
from studies.ask.settings import configured, rubbing
from studies.output.atomic import SCHEMA, as_line, as_text
from studies.scenes.plugins import blamed
from studies.scenes.walk import Visited, no_starts, walk
from studies.solving.recording import record
from studies.solving.result import Result

KINDS = (of_elements.ASSEMBLY, *of_contact.KINDS)  # of floating-point operations
StartsOf = Callable[[SceneModel], Callable[[Stage], Starts]]


@dataclass(frozen=True, eq=False)
class Walked:
    """A path that was followed already: its requested points, with the CPU and wall time and the operations spent."""

    model: SceneModel
    visits: Sequence[Visited]
    clocks: Mapping[str, float]
    work: Mapping[str, int]


class Interrupted(KeyboardInterrupt):
    """An interruption of a solve; result: what was finished before it."""

    def __init__(self, result: Result) -> None:
        super().__init__(result.reason)
        self.result = result


class Late(KeyboardInterrupt):
    """Raised within a path that takes longer than it may."""


def word(stop: BaseException) -> str:
    """What has stopped a solve, in words."""
    return str(stop) or "interrupted"


def solve(
    scene: Scene,
    request: Request,
    progress: Callable[[str], None] = lambda text: None,
    starts: StartsOf | None = None,
    walked: Walked | None = None,
) -> Result:
    """Run the stages of the scene until done or until one fails; failure and refusal are recorded, not raised.

    starts: of the model, where its steps set out from; by default each from the last state of the path.
    walked: the path, where it was followed already and only has to be judged.
    Raises Interrupted, and PartError where a part from outside breaks.
    """

    def tell(stage: str, at: float) -> None:
        progress(f"{stage} {at:g}")

    start, spent, stop = time.perf_counter(), time.process_time(), KeyboardInterrupt()
    with counted() as work, blamed(request.contact, request.measure, scene):
        model = scene.build(request) if walked is None else walked.model
        result = Result(request, model, work=work)
        built = time.perf_counter()
        result.counters["dofs"] = model.n_unknowns
        try:
            algorithm = configured(request.contact, request.settings)
        except ValueError as error:  # a parameter that it cannot have
            result.outcome, result.unsupported = Outcome.REFUSED, f"{request.contact} does not apply: {error}"
        else:
            result.epsilon = algorithm.epsilon
            try:
                path: Iterable[Visited] = walked.visits if walked is not None else ()
                if walked is None:
                    start_of = no_starts if starts is None else starts(model)
                    path = walk(stages_of(model, request), algorithm, request.steps, tell=tell, starts=start_of)
                for visited in path:
                    record(visited, result)
                    if result.outcome is Outcome.WRONG:
                        break  # no equilibrium leads further
            except KeyboardInterrupt as error:
                stop = error
                result.outcome = result.cause = Outcome.INTERRUPTED
                result.reason = f"{word(stop)} with {len(result.loads) or 'no'} loads finished"
    clocks = {"total": time.perf_counter() - start, "cpu": time.process_time() - spent}
    if walked is not None:
        clocks = {name: seconds + walked.clocks[name] for name, seconds in clocks.items()}
        work.update({kind: done + walked.work[kind] for kind, done in work.items()})
    # last, so that nothing an algorithm counts under these names is added to them
    result.counters |= {"dofs": model.n_unknowns, "operations": sum(work.values())}
    times = {key[:-2]: result.counters.pop(key) for key in list(result.counters) if key.endswith("_s")}
    result.timing = {**clocks, "build": built - start, **times}
    result.counters = {key: int(value) for key, value in result.counters.items()}
    if result.outcome is Outcome.INTERRUPTED:
        raise Interrupted(result) from stop
    return result


def record_of(cell_id: str, scene: Scene, request: Request, directory: Path | None) -> str:
    """The record of a cell as JSON; its files go into the directory, if they are to be kept.

    A scene that refuses to be built is a record, too. Raises what solving raises.
    """
    try:
        result = solve(scene, request)
    except UsageError as error:
        result = Result(request, unsupported=str(error))
    files = [] if directory is None or result.unsupported else result.write_artefacts(directory)
    record = result.as_json()
    record["reason"] = as_line(record["reason"])
    return as_text({"schema": SCHEMA, "id": cell_id, **record, "files": files})


def stages_of(model: SceneModel, request: Request) -> Iterable[Stage]:
    """Those of the model; with friction, if it is asked for."""
    if not rubbing(request.settings):
        return model.stages()
    from studies.solving.friction_stages import Stages  # loaded with friction alone

    return Stages(model.stages(), request.settings)


@contextmanager
def counted() -> Iterator[dict[str, int]]:
    """Operations of what is done inside, by kind; filled in when it has ended, however it ends."""
    before, work = _done(), dict[str, int]()
    try:
        yield work
    finally:
        work.update({kind: done - before[kind] for kind, done in _done().items()})


def _done() -> dict[str, int]:
    return {**of_elements.SPENT, **of_contact.SPENT}
