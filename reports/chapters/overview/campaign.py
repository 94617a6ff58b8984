"""The page that any campaign supports: completeness, orders and references, outcomes and counters, refusals."""

from __future__ import annotations

import math
from collections.abc import Iterator

from reports.chapters.overview.outcomes import completeness, origin, refusals
from reports.formats import NOTHING, code, digits, fixed, percent, scientific
from reports.markdown import Part, joined, listing, machine, prose, table
from reports.tables import Cell, Store

COUNTERS = ("newton_iterations", "factorisations", "assemblies", "flops")
LEAST = 3  # meshes of a sequence


def campaign_page(store: Store, contents: str = "") -> Part:
    """The whole page; contents: the list of the other pages. Times are those of its last block."""
    head = f"# Campaign `{store.campaign}`\n\n{store.title}." + (f"\n\n{contents}" if contents else "")
    sections = (_sequences, _outcomes, _refused, _unfinished, origin)
    return joined(head, "## Completeness", completeness(store), *(section(store) for section in sections))


def _sequences(store: Store) -> str:
    heading = "## Orders and references"
    rows = list(_rows(store)) if store.has_analysis("convergence") else []
    if not rows:
        return f"{heading}\n\nNo request was solved and analysed on 3 meshes or more."
    header = ["scene", "measure", "quantity", "meshes", "finest", "order", "limit", "reference", "kind", "error"]
    words = prose("""Requests that were solved on 3 meshes or more and differ in nothing else; of two meshes that hardly
differ the finer one counts. The order is that of the last three; the error is that of the limit, where there is an
order, and of the finest mesh elsewhere.""")
    return f"{heading}\n\n{words}\n\n" + table("Sequences of meshes", header, rows, words=4)


def _rows(store: Store) -> Iterator[list[str]]:
    """A row for each sequence and reference."""
    data, errors = store.analysis("convergence"), store.analysis("convergence_errors")
    for sequence, own in data[data["ladder"] == ""].groupby("sequence", sort=False):
        first, finest = own.iloc[0], own.iloc[-1]
        head = [first["scene"], first["measure"], first["quantity"], ", ".join(own["mesh"])]
        told = [digits(finest["value"], 6), fixed(finest["order"], 2), digits(first["limit"], 6)]
        known = errors[errors["sequence"] == sequence].drop_duplicates("reference", keep="last")
        if known.empty:
            yield [*head, *told, NOTHING, NOTHING, NOTHING]
        for each in known.to_dict("records"):
            error = each["error"] if math.isnan(first["limit"]) else each["model_part"]
            yield [*head, *told, digits(each["value"], 6), each["kind"], percent(error)]


def _outcomes(store: Store) -> str:
    groups: dict[tuple[str, ...], list[Cell]] = {}
    for each in store.planned:
        asked = each.asked
        key = (each.scene, str(asked.get("contact", "semismooth")), str(asked["settings"].get("tolerance", "")))
        if each.ended not in ("unsupported", "missing"):
            groups.setdefault(key, []).append(each)
    rows = []
    for (scene, contact, tolerance), group in groups.items():
        counters = [each.result["counters"] for each in group if each.result and each.ended == "converged"]
        *sums, flops = (sum(each.get(name, 0) for each in counters) for name in COUNTERS)
        tol = scientific(float(tolerance), 0) if tolerance else NOTHING
        counts = len(group), len(counters), len(group) - len(counters)
        rows.append([scene, code(contact), tol, *counts, *sums, scientific(float(flops), 2)])
    header = ["scene", "algorithm", "tolerance", "solved", "converged", "failed", "Newton iterations"]
    header += ["factorisations", "assemblies", "flops of the factorisations"]
    return "## Outcomes and counters\n\n" + table("Sums over the converged cells of each group", header, rows, words=2)


def _refused(store: Store) -> str:
    return f"## Refused\n\n{refusals(store)}"


def _unfinished(store: Store) -> str:
    found = [each for each in store.planned if each.ended in ("wrong", "not-converged", "cap-hit")]
    if not found:
        return "## Not converged\n\nNone."
    title = "Cells that were solved and did not converge"
    names = listing(title, found, "cell | class", "{label} | {ended}", words=2)
    reasons = listing("How they ended", found, "cell | reason", "{label} | {reason}", words=2)
    return f"## Not converged\n\n{names}\n\n{machine(reasons)}"
