"""A scene over one or two settings: every combination a member, each started from solved members beside it.

All have one grid, and the same stages: what a step of a stage has moved there it moves here, nearly. That is a start:
a member is judged as any solve is, and where a start leads to no stable state it is followed from rest. One that fails
is recorded, and the others go on. Where a problem has several stable states a member may be in that of its neighbours,
and not in the one to which the path from rest leads.

With an error each member is followed on two coarser grids as well, which bound its error; the first one on a grid
sets out from the next coarser one.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from studies.ask.request import Request, UsageError
from studies.ask.scene import Scene
from studies.output.atomic import Table, forget, write_json
from studies.output.provenance import provenance
from studies.scenes import SCENES
from studies.scenes.complete import complete
from studies.solving.refinement.grids import on_one_grid
from studies.solving.refinement.mesh_error import TWICE, coarser_grids, enough, state_error
from studies.solving.refinement.nested import Sketch, sketch, starts_of
from studies.solving.refinement.records import default_quantity
from studies.solving.result import CONVERGED, SOLVED, UNSUPPORTED, Result
from studies.solving.solve import solve
from studies.sweeps.members import DIRECTIONS, REST, Kept, Member, Place, Range, order, places, ranges_of, settings_at
from studies.sweeps.neighbours import Followed, Neighbours, predicted

SWEEP, TABLE, MEMBERS = "sweep.json", "sweep.csv", "members"  # the answer, which comes last
COARSER = "a coarser grid"


@dataclass(eq=False)
class Sweep:
    """What is asked, and the outcome; members: by place.

    requests: of the members; of an invalid one the reason.  middle: the request in the middle, for whose error the
    lines of all are where the scene is adapted.  coarser: meshes that bound the error, fine to coarse; none without an
    ``error``.
    """

    name: str
    scene: Scene
    ranges: tuple[Range, ...]
    requests: Mapping[Place, Request | str]
    middle: Request
    adapted: bool
    coarser: Sequence[tuple[int, int]] = ()
    error: float | None = None
    quantity: str = ""
    members: dict[Place, Member] = field(default_factory=dict)

    def named(self, place: Place) -> str:
        """A member by its settings."""
        return " ".join(f"{key}={value:.6g}" for key, value in settings_at(self.ranges, place).items())

    @property
    def rows(self) -> list[dict[str, Any]]:
        """A row a member, as they stand in the table."""
        members = [self.members[place] for place in places(self.ranges)]
        names = dict.fromkeys(name for each in members for name in each.quantities)
        return [self._row(each, names) for each in members]

    def _row(self, member: Member, names: Mapping[str, None]) -> dict[str, Any]:
        interval = member.errors.get(self.quantity, {})
        known = {end: interval.get(end) for end in ("low", "high")} | {"error": member.error(self.quantity)}
        return {
            **member.settings,
            "verdict": member.verdict,
            **{name: member.quantities.get(name) for name in names},
            **({} if self.error is None else known),
            "newton_iterations": member.newton_iterations,
            "seconds": member.seconds,
            "started_from": member.started_from,
            "reason": member.reason,
        }

    @property
    def failed(self) -> list[Member]:
        """Members without an answer."""
        return [member for member in self.members.values() if not member.solved]

    @property
    def within(self) -> int:
        """Members whose error is surely the one asked for, or less."""
        errors = (member.error(self.quantity) for member in self.members.values())
        return sum(each is not None and self.error is not None and each <= self.error for each in errors)

    @property
    def seconds(self) -> float:
        """CPU time of all members, those that were read included."""
        return sum(member.seconds for member in self.members.values())

    @property
    def cold(self) -> float | None:
        """CPU seconds of a member from rest, their mean; None where none is, or coarser grids are counted with it."""
        spent = [each.seconds for each in self.members.values() if each.solved and each.started_from == REST]
        return sum(spent) / len(spent) if spent and not self.coarser else None

    @property
    def picture(self) -> tuple[list[dict[str, Any]], dict[str, Sequence[float]], str, float | None]:
        """What its picture is drawn of: rows, values by setting, the quantity, and the error asked for."""
        return self.rows, {each.key: each.values for each in self.ranges}, self.quantity, self.error

    def as_json(self) -> dict[str, Any]:
        """The content of sweep.json."""
        request, swept = self.middle.data, [each.key for each in self.ranges]
        request["settings"] = {key: value for key, value in self.middle.settings.items() if key not in swept}
        return {
            **request,
            "mesh": self.middle.mesh_text,
            "over": {each.key: each.values for each in self.ranges},
            "quantity": self.quantity,
            "error_asked": self.error,
            "within_error": None if self.error is None else self.within,
            "failed": len(self.failed),
            "members": self.rows,
            "timing_s": {"cpu": self.seconds, "from_rest": self.cold},
            "provenance": provenance(),
        }

    def write(self, directory: Path, beside: Sequence[str] = ()) -> None:
        """The table, and sweep.json, which names it and what is ``beside``; each whole, sweep.json last."""
        Table.of_rows(self.rows).write(directory / TABLE)
        forget(directory, SWEEP, [TABLE, *beside])
        write_json(directory / SWEEP, self.as_json() | {"files": [TABLE, *beside]})


def sweep(
    name: str,
    given: Mapping[str, object],
    over: Mapping[str, str | Sequence[float]],
    error: float | None = None,
    quantity: str | None = None,
    keep: Path | None = None,
    progress: Callable[[int, int, str], None] = lambda done, planned, label: None,
    mesh: str | Sequence[int] | None = None,
    **options: Any,
) -> Sweep:
    """Solve all members, each kept in the folder ``keep`` as soon as it is; those that are there are read.

    over: "A:B:N", or evenly spaced values, by setting.  error: relative; what coarser grids say of it is stated.
    quantity: that is looked at, by default the force, or the first that the scene has references for.  options:
    measure, contact, newton, model, steps. Raises UsageError with one line, Interrupted, and PartError.
    """
    swept = _asked(name, given, over, error, mesh, options)
    kept = None if keep is None else Kept(keep, name, [swept.coarser, swept.adapted])
    across = min(len(each.values) for each in swept.ranges) if len(swept.ranges) > 1 else 1
    grids = [Neighbours(DIRECTIONS * (across + 1)) for _ in (*swept.coarser, None)]
    for place in order(swept.ranges):
        request = swept.requests[place]
        read = None if kept is None or isinstance(request, str) else kept.read(request)
        if read is not None:  # another sweep may have kept it, over other settings
            read = replace(read, settings=settings_at(swept.ranges, place))
        member = read or _member(swept, place, request, grids)
        if member.solved and not swept.quantity:
            swept.quantity = quantity or default_quantity(swept.scene, member.quantities)
            if swept.quantity not in member.quantities:
                raise UsageError(f"{name} has no quantity {quantity!r}; it has {', '.join(member.quantities)}")
        if read is None and kept is not None and not isinstance(request, str) and member.verdict != UNSUPPORTED:
            kept.write(request, member)
        swept.members[place] = member
        progress(len(swept.members), len(swept.requests), swept.named(place))
    if all(member.verdict == UNSUPPORTED for member in swept.members.values()):
        raise UsageError(next(iter(swept.members.values())).reason)
    return swept


def _asked(
    name: str,
    given: Mapping[str, object],
    over: Mapping[str, str | Sequence[float]],
    error: float | None,
    mesh: str | Sequence[int] | None,
    options: Mapping[str, Any],
) -> Sweep:
    """The members, and the grid of all of them: that of the one in the middle, where lines follow its error."""
    if name not in SCENES:
        complete(name, given)  # raises
    ranges = ranges_of(name, over, given, options.get("contact", Request.contact))
    requests: dict[Place, Request | str] = {}
    for place in places(ranges):
        try:
            requests[place] = complete(name, {**given, **settings_at(ranges, place)}, mesh, **options)[1]
        except UsageError as refusal:
            requests[place] = str(refusal)
    centre = tuple(len(each.values) // 2 for each in ranges)
    middle = min(requests, key=lambda place: (isinstance(requests[place], str), math.dist(place, centre)))
    request, scene = requests[middle], SCENES[name]
    if isinstance(request, str):
        raise UsageError(request)
    scene = on_one_grid(scene, request)
    swept = Sweep(name, scene, ranges, requests, request, scene is not SCENES[name], error=error)
    if error is not None:
        swept.coarser = [each.mesh for each in coarser_grids(scene, request)]
        if len(swept.coarser) < TWICE:
            least = "{}x{}".format(*enough(scene))
            raise UsageError(f"mesh {request.mesh_text}: its error takes grids of half and a quarter: {least} or more")
    return swept


def _member(swept: Sweep, place: Place, request: Request | str, grids: Sequence[Neighbours]) -> Member:
    """Solve one member; grids: what is known on the coarser ones, coarse to fine, and on its own."""
    start, settings = time.process_time(), settings_at(swept.ranges, place)
    try:
        if isinstance(request, str):
            raise UsageError(request)
        result, whence = _followed(swept, place, request, grids)
    except UsageError as refusal:  # of a scene that is built only now, too
        return Member(settings, UNSUPPORTED, str(refusal))
    quantities = result.quantities if result.verdict in SOLVED else {}
    return Member(
        settings,
        result.verdict,
        "; ".join(result.notes) if result.verdict == CONVERGED else str(result.as_json()["reason"]),
        {key: float(value) if math.isfinite(value) else None for key, value in quantities.items()},
        result.errors,
        int(result.counters.get("newton_iterations", 0)),
        time.process_time() - start,
        whence,
    ).normal


def _followed(swept: Sweep, place: Place, request: Request, grids: Sequence[Neighbours]) -> tuple[Result, str]:
    """The result on all grids, and what it was started from."""
    paths, coarser = list[Sketch](), [replace(request, mesh=mesh) for mesh in reversed(swept.coarser)]
    lost = dict[str, str]()
    for each, known in zip(coarser, grids, strict=False):
        near = known.of(place, each)
        path = sketch(swept.scene, each, starts=predicted(near, each)) if near else None
        tell = partial(lost.__setitem__, each.mesh_text)
        path = path or sketch(swept.scene, each, paths[-1] if paths else None, lost=tell)
        if path is not None:
            paths.append(path)
            known.add(Followed.of(place, path.request, path.visits))
    starts, whence, near = None, REST, grids[-1].of(place, request)
    if near:
        starts, whence = predicted(near, request), " and ".join(swept.named(each.place) for each in near)
    elif paths and paths[-1].model is not None:
        starts, whence = partial(starts_of, paths[-1]), COARSER
    result = solve(swept.scene, request, starts=starts)
    if starts is not None and result.verdict != CONVERGED and not result.unsupported:
        result, whence = solve(swept.scene, request), REST
    if result.verdict == CONVERGED:
        grids[-1].add(Followed.of(place, request, result.visits))
    if swept.error is not None:
        state_error(swept.scene, result, coarser[::-1], paths, lost)
    return result, whence
