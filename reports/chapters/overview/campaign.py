"""The page that any campaign supports: completeness, orders and references, outcomes and counters, refusals."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from reports.chapters.overview.outcomes import completeness, refusals
from reports.ladders import applies
from reports.markdown import NOTHING, Part, digits, fixed, machine, percent, prose, scientific, table
from reports.orders import MeshSequence
from reports.tables import Cell, Planned, Store

COUNTERS = ("newton_iterations", "factorisations", "assemblies", "flops")
LEAST = 3  # meshes of a sequence


def campaign_page(store: Store, contents: str = "") -> Part:
    """The whole page; contents: the list of the other pages. Nothing on it is a time."""
    head = f"# Campaign `{store.campaign}`\n\n{store.title}." + (f"\n\n{contents}" if contents else "")
    sections = (_sequences, _outcomes, _refused, _unfinished)
    parts = [head, f"## Completeness\n\n{completeness(store)}", *(section(store) for section in sections)]
    return Part("\n\n".join(parts) + "\n")


def _sequences(store: Store) -> str:
    rows = [row for group in _ladders(store) for row in _rows(store, group)]
    if not rows:
        return f"## Orders and references\n\nNo request was solved on {LEAST} meshes or more."
    header = ["scene", "measure", "quantity", "meshes", "finest", "order", "limit", "reference", "kind", "error"]
    words = prose(f"""Requests that were solved on {LEAST} meshes or more and differ in nothing else. The order is that
of the last three; the error is that of the limit, where there is an order, and of the finest mesh elsewhere.""")
    return f"## Orders and references\n\n{words}\n\n" + table("Sequences of meshes", header, rows, words=4)


def _ladders(store: Store) -> Iterator[list[Planned]]:
    """Converged cells that differ in their meshes only, coarse to fine."""
    found: dict[str, dict[str, Planned]] = {}
    for each in store.planned:
        if each.ended == "converged" and each.result is not None:
            rest = {key: value for key, value in each.asked.items() if key not in ("mesh", "model_reason")}
            found.setdefault(repr(rest), {}).setdefault(each.result["mesh"], each)
    for group in found.values():
        if len(group) >= LEAST:
            yield sorted(group.values(), key=_fineness)


def _fineness(planned: Planned) -> int:
    """Elements along the longer side."""
    assert planned.result is not None
    return max(int(n) for n in planned.result["mesh"].split("x"))


def _rows(store: Store, group: list[Planned]) -> Iterator[list[str]]:
    """A row for each headline quantity with a reference; without any, for the first quantity."""
    results = [each.result for each in group if each.result is not None]
    finest, sizes = results[-1], tuple(1 / _fineness(each) for each in group)
    known = {q: _references(store, group[-1], finest, q) for q in finest["quantities"]}
    chosen = [q for q, references in known.items() if references] or list(known)[:1]
    for quantity in chosen:
        values = tuple(_number(result["quantities"].get(quantity)) for result in results)
        sequence = MeshSequence(sizes, values)
        order, limit = sequence.orders[-1], sequence.limit
        head = [finest["scene"], finest["measure"], quantity, ", ".join(result["mesh"] for result in results)]
        told = [digits(values[-1], 6), NOTHING if order is None else fixed(order, 2)]
        told.append(NOTHING if limit is None else digits(limit, 6))
        if not known[quantity]:
            yield [*head, *told, NOTHING, NOTHING, NOTHING]
        for reference in known[quantity]:
            best = values[-1] if limit is None else limit
            error = best / float(reference["value"]) - 1
            yield [*head, *told, digits(float(reference["value"]), 6), reference["kind"], percent(error)]


def _references(store: Store, planned: Planned, result: Mapping[str, Any], quantity: str) -> list[Mapping[str, Any]]:
    """Those that hold at the last load."""
    cell = Cell(planned.label, planned.scene, planned.command, store.path, result)
    asked = (row for row in store.references if row["scene"] == planned.scene and row["quantity"] == quantity)
    return [row for row in asked if float(row["value"]) != 0 and applies(row["at"], cell, {})]


def _number(value: Any) -> float:
    return float("nan") if value is None else float(value)


def _outcomes(store: Store) -> str:
    groups: dict[tuple[str, ...], list[Planned]] = {}
    for each in store.planned:
        asked = each.asked
        key = (each.scene, str(asked.get("contact", "semismooth")), str(asked["settings"].get("tolerance", "")))
        groups.setdefault(key, []).append(each)
    rows = []
    for (scene, contact, tolerance), group in groups.items():
        results = [each.result for each in group if each.result is not None and each.ended == "converged"]
        solved = sum(each.ended not in ("unsupported", "missing") for each in group)
        if not solved:
            continue
        sums = {name: sum(result["counters"].get(name, 0) for result in results) for name in COUNTERS}
        counts = [
            str(solved),
            str(len(results)),
            str(solved - len(results)),
            *(str(sums[name]) for name in COUNTERS[:-1]),
        ]
        tol = scientific(float(tolerance), 0) if tolerance else NOTHING
        rows.append([scene, f"`{contact}`", tol, *counts, scientific(float(sums["flops"]), 2)])
    header = ["scene", "algorithm", "tolerance", "solved", "converged", "failed", "Newton iterations"]
    header += ["factorisations", "assemblies", "flops of the factorisations"]
    return "## Outcomes and counters\n\n" + table("Sums over the converged cells of each group", header, rows, words=2)


def _refused(store: Store) -> str:
    return f"## Refused\n\n{refusals(store)}"


def _unfinished(store: Store) -> str:
    found = [each for each in store.planned if each.ended in ("wrong", "not-converged", "cap-hit")]
    if not found:
        return "## Not converged\n\nNone."
    rows = ([each.label, each.ended] for each in found)
    names = table("Cells that were solved and did not converge", ["cell", "class"], rows, words=2)
    reasons = table("How they ended", ["cell", "reason"], ([each.label, each.reason] for each in found), words=2)
    return f"## Not converged\n\n{names}\n\n{machine(reasons)}"
