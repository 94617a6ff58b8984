"""The page that any campaign supports: completeness, orders and references, outcomes and counters, refusals."""

from __future__ import annotations

import pandas as pd

from reports.chapter import INDEX_TITLE
from reports.chapters.overview.outcomes import completeness, refusals
from reports.formats import NOTHING, code, scientific
from reports.markdown import Part, joined, listing, machine, prose, table
from reports.origin import origin
from reports.store.cells import Cell
from reports.store.tables import Store

GOOD = ("converged", "unstable")
COUNTERS = ("newton_iterations", "factorisations", "assemblies", "operations")


def campaign_page(store: Store, contents: str = "") -> Part:
    """The whole page; contents: the list of the other pages. Times are those of its last block."""
    head = f"# {INDEX_TITLE}\n\n{store.title}: the campaign `{store.campaign}`."
    made: list[Part | str] = [
        head,
        *(["## Pages", contents] if contents else []),
        origin(store),
    ]
    refused = f"## Refused\n\n{refusals(store)}"
    sections = _sequences(store), _outcomes(store), refused, _unfinished(store)
    return joined(*made, *sections, "## Completeness", completeness(store))


def _sequences(store: Store) -> Part:
    """A row for each sequence and reference."""
    heading = "## Orders and references"
    data = store.analysis("convergence") if store.has_analysis("convergence") else pd.DataFrame({"ladder": []})
    own = data[data["ladder"] == ""]
    if own.empty:
        return joined(heading, "No request was solved and analysed on 3 meshes or more.")
    known = store.analysis("convergence_errors").drop_duplicates(["sequence", "reference"], keep="last")
    known = known.assign(known=known["value"])[["sequence", "known", "kind", "error", "model_part"]]
    meshes = own.groupby("sequence")["mesh"].agg(", ".join).rename("meshes")
    finest = own.drop_duplicates("sequence", keep="last").join(meshes, on="sequence")
    found = finest.merge(known, how="left", on="sequence").fillna({"kind": ""})
    found["off"] = found["error"].where(found["limit"].isna(), found["model_part"])
    heads = "scene | measure | quantity | meshes | finest | order | limit | reference | kind | error"
    line = "{scene} | {measure} | {quantity} | {meshes} | {value:#.6g} | {order:.2f} | {limit:#.6g} | {known:#.6g} | "
    line += "{kind:said} | {off:+.2%}"
    words = prose("""Requests that were solved on 3 meshes or more and differ in nothing else; of two meshes that hardly
differ the finer one counts. The order is that of the last three; the error is that of the limit, where there is an
order, and of the finest mesh elsewhere.""")
    return joined(heading, words, listing("Sequences of meshes", found, heads, line, words=4))


def _outcomes(store: Store) -> str:
    groups: dict[tuple[str, ...], list[Cell]] = {}
    for each in store.planned:
        asked = each.asked
        key = (each.scene, str(asked.get("contact", "semismooth")), str(asked["settings"].get("tolerance", "")))
        if each.ended not in ("unsupported", "missing"):
            groups.setdefault(key, []).append(each)
    rows = []
    for (scene, contact, tolerance), group in groups.items():
        counters = [each.result["counters"] for each in group if each.result and each.ended in GOOD]
        *sums, operations = (sum(each.get(name, 0) for each in counters) for name in COUNTERS)
        tol = scientific(float(tolerance), 0) if tolerance else NOTHING
        counts = len(group), len(counters), len(group) - len(counters)
        rows.append([scene, code(contact), tol, *counts, *sums, scientific(float(operations), 2)])
    header = ["scene", "algorithm", "tolerance", "solved", "converged", "failed", "Newton iterations"]
    header += ["factorisations", "assemblies", "operations"]
    return "## Outcomes and counters\n\n" + table("Sums over the converged cells of each group", header, rows, words=2)


def _unfinished(store: Store) -> str:
    found = [each for each in store.planned if each.ended in ("wrong", "not-converged", "cap-hit")]
    if not found:
        return "## Not converged\n\nNone."
    title = "Cells that were solved and did not converge"
    names = listing(title, found, "cell | class", "{label} | {ended}", words=2)
    reasons = listing("How they ended", found, "cell | reason", "{label} | {reason}", words=2)
    return f"## Not converged\n\n{names}\n\n{machine(reasons)}"
