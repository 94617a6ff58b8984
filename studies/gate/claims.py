"""What a record claims, held against what its field comes to; the first claim that is not so is named, with its size.

Rules: a residual may be claimed larger than it is, never smaller by more than rounding; a quantity agrees to AGREE, or
to what other last digits of the field make of it; one of a stage that was solved again to RESOLVED. Counters, times,
and loads before the last one cannot be recomputed from a field: they stay claims, and are listed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from contact.continuation.stability import UNSTABLE as UNSTABLE_WORD
from contact.problem import ContactSolution
from studies.ask.request import Request
from studies.ask.scene import CurveStage, moved
from studies.gate.foreign import ClaimError, Foreign
from studies.gate.recompute import Opened, Recomputed, arrays_of, as_written
from studies.output.atomic import Table, plain
from studies.output.vtu import FIELDS
from studies.solving.result import CONVERGED, SOLVED, UNSTABLE, UNSUPPORTED, WRONG, seen_in

AGREE, RESOLVED = 1e-9, 1e-6  # relative
SHAKEN = 8  # times what other last digits make of a quantity
ASKED = ("scene", "measure", "contact", "newton", "model")
CERTIFIED = "converged"  # the outcome of which a field can tell
ALWAYS_CLAIMED = ("counters", "times", "machine", "history")


def claims_success(record: Mapping[str, Any]) -> bool:
    """Whether outcome and class claim an equilibrium; raises ClaimError where the two exclude each other."""
    outcome, kind = record["outcome"], record["class"]
    if (outcome == CERTIFIED) != (kind in SOLVED) or (outcome == UNSUPPORTED) != (kind == UNSUPPORTED):
        raise ClaimError("class", f"claimed {kind!r} of a cell whose outcome is {outcome!r}")
    return bool(outcome == CERTIFIED)


def check_request(record: Mapping[str, Any], request: Request) -> None:
    """Raise ClaimError unless the record is of this request."""
    expected = {name: getattr(request, name) for name in ASKED}
    expected["mesh"] = "x".join(map(str, request.mesh))
    settings = {**request.settings, "steps": request.steps}
    for claimed, asked in ((record, expected), (record["settings"], plain(settings))):
        for name, value in asked.items():
            if claimed.get(name) != value:
                raise ClaimError("request", f"{name} claimed {claimed.get(name)!r}, the plan asks for {value!r}")
    for name in sorted(record["settings"].keys() - settings.keys()):
        raise ClaimError("request", f"{name} is not a setting of {request.scene}")


def verify(record: Mapping[str, Any], request: Request, foreign: Foreign) -> tuple[bytes, list[str]]:
    """Recompute what a record claims from its field; raises ClaimError with the first claim that is not so.

    Returns the field as this program writes it, and what is only claimed.
    """
    check_request(record, request)
    opened = Opened.of(request)
    steps = record["steps"]
    load = _load(steps, opened)
    own, arrays = as_written(opened.model, ContactSolution.at_rest(opened.model.n_unknowns, 0))
    largest = 65536 + 2 * len(own) + 4 * sum(values.nbytes for values in arrays.values())
    fields = arrays_of(foreign.beside(record["id"], FIELDS, largest), arrays)
    recomputed = opened.at(load, fields, steps[-1].get("contact_nodes"))
    _steps(steps, load, recomputed, opened)
    _residuals(steps[-1], recomputed)
    _verdict(record, recomputed, opened)
    claimed = [*ALWAYS_CLAIMED, *(["loads before the last"] if len(steps) > 1 else [])]
    claimed += _quantities(record, recomputed, opened)
    _counters(record, opened)
    for name, table in recomputed.seen.tables().items():
        check_table(name, table, foreign.table(record["id"], f"{name}.csv"))
    return as_written(moved(opened.model, load), recomputed.state)[0], claimed


def _load(steps: Sequence[Mapping[str, Any]], opened: Opened) -> float:
    """At which the field is judged: the last one that was asked for, or the end that a curve claims."""
    if not steps:
        raise ClaimError("outcome", "claimed converged, without a single load")
    if not opened.curve:
        return float(opened.stage.targets[-1])
    load = _number(next(iter(steps[-1].values()), None), "load")
    if not math.isfinite(load):
        raise ClaimError("load", f"claimed {load}")
    return load


def _steps(steps: Sequence[Mapping[str, Any]], load: float, recomputed: Recomputed, opened: Opened) -> None:
    """There must be one a load, each at its own."""
    stage = opened.stage
    if isinstance(stage, CurveStage):
        until = getattr(stage.continuation, "to_limit", False)
        if not until and load < (1 - AGREE) * stage.targets[-1]:
            raise ClaimError("load", f"claimed converged at {load:g}, the request goes to {stage.targets[-1]:g}")
        return
    expected = opened.recorded + len(stage.targets)
    if len(steps) != expected:
        raise ClaimError("outcome", f"claimed converged with {len(steps)} loads of {expected}")
    key, value = next(iter((recomputed.seen.step or {"": None}).items()))
    for step, target in zip(steps[opened.recorded :], stage.targets, strict=True):
        asked = target if value == load else value
        if not _close(claimed := _number(step.get(key), key), float(asked), AGREE):
            raise ClaimError("load", f"{key} claimed {claimed!r}, the request asks for {asked:g}")


def _residuals(step: Mapping[str, Any], recomputed: Recomputed) -> None:
    """None may be smaller than it is."""
    verdict, gap = recomputed.verdict, recomputed.verdict.gap_bound(max(recomputed.gap_share, 2e-12))
    rounding = {
        "equilibrium": verdict.rounding,
        "penetration": gap,
        "tension": 0.0,
        "complementarity": gap * verdict.pressure,
    }
    residuals = step.get("kkt", {})
    for name, value in recomputed.kkt.items():
        claimed = _number(residuals.get(name), name)
        if not value <= (1 + RESOLVED) * claimed + rounding[name]:
            raise ClaimError(name, f"claimed {claimed:.3g}, found {value:.3g}")


def _verdict(record: Mapping[str, Any], recomputed: Recomputed, opened: Opened) -> None:
    """The class must follow from the failures and the stability of all loads, those of the last one as found."""
    steps, last = record["steps"], record["steps"][-1]
    failures = last.get("failures")
    if not isinstance(failures, list):
        raise ClaimError("failures", "is not claimed")
    if not {*recomputed.failures} <= set(map(str, failures)):
        worst = next(each for each in recomputed.failures if each not in failures)
        has = {**recomputed.kkt, **recomputed.verdict.balances}[worst]
        raise ClaimError("failures", f"claimed {failures or 'none'}, the judge finds {worst} = {has:.3g}")
    if any(step.keys() != last.keys() for step in steps):
        raise ClaimError("steps", "do not claim the same of every load")
    words = [_word(step) for step in steps]
    if words[-1] != recomputed.stable:
        raise ClaimError("stability", f"claimed {words[-1]!r}, found {recomputed.stable!r}")
    failed, unstable = any(step.get("failures") for step in steps), UNSTABLE_WORD in words and not opened.curve
    follows = WRONG if failed else UNSTABLE if unstable else CONVERGED
    if record["class"] != follows:
        raise ClaimError("class", f"claimed {record['class']!r}, its loads come to {follows!r}")


def _word(step: Mapping[str, Any]) -> str:
    if "word" not in step.get("stability", {}) or "failures" not in step:
        raise ClaimError("stability", "is not claimed of every load")
    return str(step["stability"]["word"])


def _quantities(record: Mapping[str, Any], recomputed: Recomputed, opened: Opened) -> Iterator[str]:
    """The headline ones and those of the last load; those that a whole curve alone can tell are yielded."""
    quantities = record["quantities"]
    last = seen_in(record["steps"][-1], record["counters"])
    own, shaken = recomputed.seen, recomputed.shaken
    observed = dict(own.step or {})
    for each, ours, others in (
        (last, observed, dict(shaken.step or {})),
        (quantities, own.quantities, shaken.quantities),
    ):
        for name, value in plain(ours).items():
            _agrees(name, each.get(name), value, AGREE, plain(others)[name])
    for name, value in opened.before.items():
        if name not in own.quantities:
            _agrees(name, quantities.get(name), value, RESOLVED, value)
    if different := sorted(last.keys() ^ observed.keys()):
        raise ClaimError("quantities", f"{', '.join(different)} is not what the scene reads")
    for name in quantities.keys() - own.quantities.keys() - opened.before.keys():
        if not opened.curve:
            raise ClaimError("quantities", f"the scene reads no {name}")
        yield name


def _agrees(name: str, claim: Any, ours: Any, share: float, shaken: Any) -> None:
    """The same but for rounding; what is not a number is the same word."""
    if not isinstance(ours, int | float) or isinstance(ours, bool):
        if claim != ours:
            raise ClaimError(name, f"claimed {claim!r}, recomputed {ours!r}")
        return
    claimed = _number(claim, name)
    moved = abs(float(shaken) - float(ours)) if isinstance(shaken, int | float) else 0.0
    if not _close(claimed, float(ours), share, SHAKEN * moved):
        off = f"{abs(claimed - ours) / abs(ours):.3g} of it" if ours else f"{abs(claimed):.3g}"
        raise ClaimError(name, f"claimed {claimed:.12g}, recomputed {ours:.12g}, a difference of {off}")


def _counters(record: Mapping[str, Any], opened: Opened) -> None:
    """Those that need no solve: the unknowns, and that operations are the sum of their kinds."""
    counters, total = record["counters"], sum(record["work"].values())
    if counters.get("dofs") != opened.model.n_unknowns:
        raise ClaimError("dofs", f"claimed {counters.get('dofs')}, the model has {opened.model.n_unknowns}")
    if counters.get("operations") != total:
        raise ClaimError("operations", f"claimed {counters.get('operations')}, their kinds sum to {total}")


def check_table(name: str, ours: Table, rows: Sequence[Sequence[str]]) -> None:
    """The last rows of a table beside the record are those of its last load."""
    head, last_rows = rows[0], rows[1:][-len(ours) :] if len(ours) else []
    if len(last_rows) != len(ours) or not {*ours.columns} <= {*head}:
        message = f"has {len(last_rows)} rows of {', '.join(head)}; {len(ours)} belong to its last load"
        raise ClaimError(f"{name}.csv", message)
    for column, values in ours.columns.items():
        at = head.index(column)
        numbers = [abs(value) for value in values if isinstance(value, int | float) and math.isfinite(value)]
        allowed = RESOLVED * max(numbers, default=0.0)
        for row, value in zip(last_rows, values, strict=True):
            if not _cell_agrees(row[at], value, allowed):
                raise ClaimError(f"{name}.csv", f"{column} claimed {row[at] or 'nothing'!r}, found {value!r}")


def _cell_agrees(text: str, value: Any, allowed: float) -> bool:
    if value is None or value != value:
        return text == ""
    if isinstance(value, str):
        return text == value
    try:
        return abs(float(text) - float(value)) <= allowed
    except ValueError:
        return text == str(value)


def _number(value: Any, name: str) -> float:
    """A number of a record; raises ClaimError for what is none."""
    if value in ("inf", "-inf"):
        return float(value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ClaimError(name, f"claimed {value!r}, which is not a number")
    return float(value)


def _close(claimed: float, ours: float, share: float, moved: float = 0.0) -> bool:
    return claimed == ours or abs(claimed - ours) <= share * max(abs(claimed), abs(ours)) + moved
