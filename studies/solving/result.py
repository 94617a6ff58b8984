"""The result of a solve: the requested loads, its class, and the files that it is written to.

How it is computed does not enter here (:mod:`studies.solving.solve`), nor what makes a state wrong
(:mod:`studies.solving.certificate`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from contact.continuation.stability import UNSTABLE as UNSTABLE  # also a class of results
from contact.events import EventKind, PathEnd, events
from contact.problem import ContactSolution, Outcome
from studies.ask.model import SceneModel
from studies.ask.request import Request
from studies.output.atomic import Table, forget, write_by, write_json
from studies.output.provenance import provenance
from studies.output.vtu import FIELDS
from studies.scenes.walk import Seen, Visited, shown, state_of

if TYPE_CHECKING:
    from contact.continuation.branches import Branch

CERTIFICATE = ("failures", "exceeded", "kkt", "balances", "rounding", "scales", "diagnosis", "stability")
UNITS = ("_N_mm", "_N", "_MPa", "_mm")  # that a quantity may end in
# which no smaller step or element changes by a smaller amount
COUNTS = ("contact_nodes", "sticking", "slipping", "limit_points")
OF_THE_PATH = ("substeps", "limit_point")  # counted beside what the algorithm counts
RESULT = "result.json"
HISTORY = ("stage", "parameter", "iteration", "residual", "contact_nodes", "added", "removed")  # at the least
UNSUPPORTED = "unsupported"  # the outcome of a request that the algorithm refuses
CONVERGED, WRONG, NOT_CONVERGED, CAP_HIT = "converged", "wrong", "not-converged", "cap-hit"
TIME, MEMORY, CRASH = "time", "memory", "crash"  # of a process that was killed, or died
CLASSES = (CONVERGED, UNSTABLE, WRONG, NOT_CONVERGED, CAP_HIT, TIME, MEMORY, CRASH, UNSUPPORTED)
UNTOUCHED = "no contact at the last load: the foundation is out of reach, or the load lifts the body off it"
APART = "no contact between the faces at the last load: they are apart, or the elements are too large"
SOLVED = (CONVERGED, UNSTABLE)  # an equilibrium that the judge certifies, stable or not


@dataclass(frozen=True, eq=False)
class Step:
    """seen: the load, which comes first, and the quantities at it {name_unit: value}; certificate: what the judge says
    of the state; counters: what it has cost; headlines: the names of the headline values that are of this load, unless
    a later one has them, too.
    """

    seen: dict[str, Any]
    certificate: Mapping[str, Any]
    counters: Mapping[str, int]
    headlines: frozenset[str]

    @property
    def load(self) -> dict[str, float]:
        """The load alone."""
        return dict(islice(self.seen.items(), 1))

    @property
    def quantities(self) -> dict[str, Any]:
        """All that was read off beside it."""
        return dict(islice(self.seen.items(), 1, None))

    @property
    def flat(self) -> dict[str, Any]:
        """The entry of ``steps`` in result.json."""
        judged = {key: self.certificate[key] for key in CERTIFICATE if key in self.certificate}
        taken = {*self.seen, *CERTIFICATE}  # no counter of an algorithm from outside stands in the place of these
        return {**self.seen, **judged, **{key: value for key, value in self.counters.items() if key not in taken}}


def seen_in(entry: Mapping[str, Any], counters: Iterable[str]) -> dict[str, Any]:
    """Load and quantities of an entry of ``steps``; counters: the names that its result counts."""
    others = {*counters, *OF_THE_PATH, *CERTIFICATE}
    return {key: value for key, value in entry.items() if key not in others}


def unit_of(quantity: str) -> str:
    """What the name of a quantity ends in; where that is not a unit, the name."""
    return next((unit for unit in UNITS if quantity.endswith(unit)), quantity)


class Frozen(Protocol):
    """The linearised problem at the end of a path, with or without friction."""

    def write(self, path: Path) -> None:
        """Into one file."""


@dataclass
class Result:
    """The result of a solve; ``last`` is the last converged state, from which the fields are written.

    model: None where the scene refuses to be built.  unsupported: why the algorithm does not apply to this problem, or
    the scene cannot be; nothing was solved beyond that.  outcome: WRONG where the judge refuses a load: the path ends
    there, and ``last`` is that state.  unstable: a sentence on each requested load whose equilibrium is not stable, but
    for the points of a traced curve, which is followed through such states on purpose.  on_the_way: the same of the
    last state of a stage that no requested load belongs to.
    work: floating-point operations by kind, those of the judge included; their sum is counters["operations"].
    visits: the requested points, in order.  ways: stage and accepted parameters on the way to each requested load, that
    included.  remarks: further notes.
    epsilon [MPa/mm]: of the contact law by which states are judged.
    errors: {quantity: {low, high}} of those whose error is estimated.
    gradients: {quantity: {setting: its derivative}} where asked for, :mod:`studies.solving.derivatives.gradient`.
    branches, beside: rows and states of the stable branches at the last load, where they were asked for.
    """

    request: Request
    model: SceneModel | None = None
    outcome: Outcome = Outcome.CONVERGED
    cause: Outcome = Outcome.CONVERGED
    reason: str = ""
    unsupported: str = ""
    unstable: list[str] = field(default_factory=list)
    on_the_way: list[str] = field(default_factory=list)
    branches: list[dict[str, Any]] = field(default_factory=list)
    beside: list[Branch] = field(default_factory=list)
    quantities: dict[str, float] = field(default_factory=dict)
    errors: dict[str, dict[str, float]] = field(default_factory=dict)
    gradients: dict[str, dict[str, dict[str, float | None]]] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)
    loads: list[Step] = field(default_factory=list)
    ways: list[tuple[str, tuple[float, ...]]] = field(default_factory=list)
    counters: dict[str, float] = field(default_factory=dict)
    work: dict[str, int] = field(default_factory=dict)
    timing: dict[str, float] = field(default_factory=dict)
    history: list[dict[str, Any]] = field(default_factory=list)
    tables: dict[str, list[Table]] = field(default_factory=dict)
    last: ContactSolution | None = None
    epsilon: float = math.inf
    frozen: Callable[[], Frozen] | None = None
    visits: list[Visited] = field(default_factory=list)
    states: list[Seen] = field(default_factory=list)

    @property
    def end(self) -> Visited | None:
        """The last requested point of the path, or where it ends before it."""
        return self.visits[-1] if self.visits else None

    @property
    def headline_loads(self) -> dict[str, int]:
        """{headline value: the number of the load that it is of}; without those that are of no load."""
        return {name: number for number, step in enumerate(self.loads) for name in step.headlines}

    def as_json(self) -> dict[str, Any]:
        """The content of result.json."""
        request = self.request
        fields = ("scene", "measure", "contact", "newton", "mesh", "model", "model_reason")
        return {
            **{name: getattr(request, name) for name in fields},
            "mesh": request.mesh_text,
            "settings": {**request.settings, "steps": request.steps},
            "outcome": UNSUPPORTED if self.unsupported else self.outcome.word,
            "class": self.verdict,
            "path_end": self.path_end,
            "reason": self.unsupported or self.reason or "; ".join(self.unstable[:1]) or self.outcome.value,
            "notes": self.notes,
            "quantities": self.quantities,
            **({"errors": self.errors} if self.errors else {}),
            **({"gradients": self.gradients} if self.gradients else {}),
            "steps": self.steps,
            **({"branches": self.branches} if self.branches else {}),
            "cuts": [str(event) for event in events(self.history, EventKind.STEP_CUT)],
            "counters": self.counters,
            "work": self.work,
            "timing_s": self.timing,
            "provenance": provenance(),
        }

    def at(self, load: float, passage: int = 0) -> ContactSolution:
        """The state where the last stage passes a load, for the first time or later (``passage`` 1, 2, ...).

        An evaluation of the curve: nothing is solved, and the judge has seen no state between those of ``steps``.
        Raises LookupError where it does not pass, and of a path that is known at its points alone.
        """
        if self.end is None or self.end.trace is None:
            raise LookupError("a path in load steps is known at its loads only")
        return self.end.stage.lifted(self.end.trace.at(load, passage).state)

    @property
    def notes(self) -> list[str]:
        """What an answer does not show by itself.

        A foundation finer than its elements, no contact at all, elements too long, unstable states on the way, remarks.
        """
        if self.end is None:
            return self.remarks
        problem, state = self.end.problem, self.end.point.solution
        fine_foundation = ""
        if problem.standing is not None:
            from contact.swept import between_nodes  # loaded with a foundation alone

            fine_foundation = between_nodes(problem.standing, problem.weights, state.active)
        apart = len(state.active) > 0 and not (state.active.any() or state.pressure.any())
        said = UNTOUCHED if problem.faces is None else APART
        notes = [each for each in (fine_foundation, said if apart else "") if each]
        return [*notes, *_of_elements(self.request, self.loads), *self.on_the_way, *self.remarks]

    @property
    def steps(self) -> list[dict[str, Any]]:
        """The loads that were reached, flat."""
        return [step.flat for step in self.loads]

    @property
    def verdict(self) -> str:
        """The class of the outcome: what a solve may end in of :data:`CLASSES`."""
        if self.unsupported:
            return UNSUPPORTED
        if self.outcome is Outcome.WRONG:
            return WRONG
        if self.outcome.converged:
            return UNSTABLE if self.unstable else CONVERGED
        capped = Outcome.ITERATION_LIMIT in (self.outcome, self.cause)
        return CAP_HIT if capped and not self.path_end else NOT_CONVERGED

    @property
    def path_end(self) -> dict[str, Any]:
        """What the path of the problem itself ends at before the load asked for: stage, kind, parameter, found_by.

        Empty where it does not end, or only the solver knows no further. Found by arc length, which has passed it, or
        by the tangent of the last states (:mod:`contact.continuation.critical_points`), which only comes near it.
        """
        point = None if self.end is None or self.outcome.converged else self.end.point
        if self.end is None or point is None or point.end is None or point.end.kind is PathEnd.NEITHER:
            return {}
        found_by = "arc length" if point.outcome is Outcome.LIMIT_POINT else "the tangent"
        at = point.reached if point.end.limit is None else point.end.limit
        return {"stage": self.end.stage.name, "kind": point.end.kind.value, "parameter": at, "found_by": found_by}

    def table(self, name: str) -> Table:
        """One of the tables, its parts from all loads below one another."""
        return Table.stacked(self.tables[name])

    def write(self, directory: Path, beside: Iterable[str] = ()) -> list[str]:
        """result.json, fields.vtu and the tables; each appears whole or not at all, result.json last.

        result.json names the files, those ``beside`` included, which are there already; what the result that was there
        before has named, and this one does not, is removed. Returns the names.
        """
        from studies.solving import fields  # a cell keeps less

        assert self.model is not None  # what was refused has no artefacts
        table_files = self._write_tables(directory)
        field_files = fields.write(directory, self.model, self.states, self._shown, table_files)
        files = [*table_files, *field_files, *beside]
        forget(directory, RESULT, files)
        self.name(directory, files)
        return files

    def name(self, directory: Path, files: Sequence[str]) -> None:
        """result.json alone, with the names of all files beside it."""
        write_json(directory / RESULT, self.as_json() | {"files": files})

    def write_artefacts(self, directory: Path) -> list[str]:
        """fields.vtu and the tables, each whole or not at all; returns their names: what a store keeps."""
        assert self.model is not None
        model, state = shown(self.model, self._shown), state_of(self.model, self._shown)
        tables = self._write_tables(directory)
        write_by(directory / FIELDS, partial(model.write_fields, state=state))
        return [*tables, FIELDS]

    @property
    def _shown(self) -> Seen | None:
        """The state of fields.vtu, with its supports where the path has ended; None at rest."""
        if self.end is None or self.last is None:
            return None
        return Seen(("", math.nan), self.end.point.reached, self.end.problem_at, self.last)

    def _write_tables(self, directory: Path) -> list[str]:
        tables = {name: self.table(name) for name in self.tables}
        for name, table in {**tables, "history": Table.of_rows(self.history, HISTORY)}.items():
            table.write(directory / f"{name}.csv")
        return [*(f"{name}.csv" for name in tables), "history.csv"]


def _of_elements(request: Request, loads: Sequence[Step]) -> list[str]:
    """Modes that elements have by themselves at the load where these are most, and the mesh that has none."""
    stable: list[dict[str, Any]] = [step.certificate.get("stability", {}) for step in loads]
    worst = max(stable, key=lambda record: record.get("element_modes", 0), default={})
    count = worst.get("element_modes", 0)
    if not count:
        return []
    removed = "them" if count > 1 else "it"
    (n1, n2), cuts = request.mesh, worst["cuts"]
    mesh = "a finer grid" if request.leaves else f"{n1 * cuts[0]}x{n2 * cuts[1]}"
    modes = f"{count} negative eigenvalue{'s' if count > 1 else ''} of elements alone, not of the shell"
    return [f"{modes}: {mesh} removes {removed}"]
