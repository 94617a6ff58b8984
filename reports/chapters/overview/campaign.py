"""The page that any campaign supports: completeness, orders and references, outcomes and counters, refusals."""

from __future__ import annotations

from typing import Any

from reports.chapter import INDEX_TITLE
from reports.chapters.overview.outcomes import completeness, refusals
from reports.markdown import Part
from reports.origin import origin
from reports.store.cells import Cell
from reports.store.tables import Store
from reports.template import Template

TEXT = Template("campaign")
GOOD = ("converged", "unstable")
COUNTERS = ("newton_iterations", "factorisations", "assemblies", "operations")


def campaign_page(store: Store, contents: str = "") -> Part:
    """The whole page; contents: the list of the other pages. Times are those of its last block."""
    parts = {"origin": origin(store), "refusals": refusals(store), "completeness": completeness(store)}
    found = [each for each in store.planned if each.ended in ("wrong", "not-converged", "cap-hit")]
    parts |= {"unfinished": TEXT("unfinished", cells=found) if found else Part("None.")}
    pages = f"## Pages\n\n{contents}" if contents else ""
    named = {"title": INDEX_TITLE, "store": store, "pages": pages}
    return TEXT("page", **named, sequences=_sequences(store), groups=_groups(store), **parts)


def _sequences(store: Store) -> Part:
    """A row for each sequence and reference."""
    own = store.rows("convergence", ladder="")
    if own.empty:
        return Part("No request was solved and analysed on 3 meshes or more.")
    known = store.table("convergence_errors").drop_duplicates(["sequence", "reference"], keep="last")
    known = known.assign(known=known["value"])[["sequence", "known", "kind", "error", "model_part"]]
    meshes = own.groupby("sequence")["mesh"].agg(", ".join).rename("meshes")
    finest = own.drop_duplicates("sequence", keep="last").join(meshes, on="sequence")
    found = finest.merge(known, how="left", on="sequence")
    found["off"] = found["error"].where(found["limit"].isna(), found["model_part"])
    return TEXT("sequences", rows=found)


def _groups(store: Store) -> list[dict[str, Any]]:
    """Outcomes by scene, algorithm and tolerance, with the sums of the counters of what has converged."""
    groups: dict[tuple[str, ...], list[Cell]] = {}
    for each in store.planned:
        asked = each.asked
        key = (each.scene, str(asked.get("contact", "semismooth")), str(asked["settings"].get("tolerance", "nan")))
        if each.ended not in ("unsupported", "missing"):
            groups.setdefault(key, []).append(each)
    rows = []
    for (scene, contact, tolerance), group in groups.items():
        counters = [each.result["counters"] for each in group if each.result and each.ended in GOOD]
        counts = {"solved": len(group), "converged": len(counters), "failed": len(group) - len(counters)}
        sums = {name: sum(each.get(name, 0) for each in counters) for name in COUNTERS}
        rows.append({"scene": scene, "contact": contact, "tolerance": float(tolerance), **counts, **sums})
    return rows
