"""The first page: what to use, why, and how sure that is; or, of a campaign of a user, what any campaign supports."""

from __future__ import annotations

from typing import Any

from reports.chapter import INDEX_TITLE, by_machine, statements
from reports.chapters.algorithms import costs_picture, when_not_table
from reports.chapters.catalogue import Catalogue
from reports.chapters.gallery import filmstrip_of
from reports.chapters.measures import decision_part, limits_part, measures_picture
from reports.chapters.tyre import model_table
from reports.markdown import Part, Template
from reports.origin import completeness, origin, refusals
from reports.store import Cell, Store

TEXT = Template("index")
STRAINS = ("measures-small", "measures-large", "measures-contact", "measures-cost", "cheapest-measure", "tyre-measure")
CONTACT = ("which-algorithm", "trial-and-error-ends", "false-solved", "epsilon-range")
SPARED = ("parts-of-the-tyre", "grids-of-the-tyre", "one-per-cent")
FORCE = ("force-known", "printed-excluded", "origin-of-travel")
SURE = ("convergence", "manufactured", "algorithms-agree", "symmetry", "random-cases", "advice")
ABOVE = (*FORCE, "tyre-mesh-and-load")  # limitations that stand there
GOOD = ("converged", "unstable")
COUNTERS = ("newton_iterations", "factorisations", "assemblies", "operations")


def index_page(store: Store, contents: str) -> Part:
    """The whole page; contents: the list of the other pages."""
    contact = TEXT("algorithms", when_not=when_not_table(), costs=costs_picture(store))
    sections = {
        "decision": decision_part(store),
        "measures": measures_picture(store),
        "strains": _section("Exact or classical strains?", store, STRAINS, TEXT("strains", limits=limits_part(store))),
        "algorithms": _section("Which contact algorithm?", store, CONTACT, contact),
        "spared": _section("What does it save?", store, SPARED),
        "force": _section("What is the tyre's force worth?", store, FORCE, model_table(store)),
        "sure": _section("How sure is this?", store, SURE, TEXT("others")),
        "limitations": limitations(store),
        "tyre": filmstrip_of(Catalogue.of(store)),
    }
    counts = {"requests": len(store.planned), "scenes": len({cell.scene for cell in store.planned})}
    return TEXT("page", title=INDEX_TITLE, **counts, **sections, contents=contents, origin=origin(store))


def _section(title: str, store: Store, names: tuple[str, ...], more: Part | str = "") -> Part:
    """Sentences by their names, in order, those that depend on the machine marked; nothing where there are none."""
    by_name = {each.name: each for each in statements(store)}
    sentences = [by_name[name] for name in names if name in by_name]
    return TEXT("section", title=title, **by_machine(sentences), more=more) if sentences else Part()


def limitations(store: Store) -> Part:
    """What does not hold, as computed, and what is not covered at all."""
    sentences = [each for each in statements(store) if each.role == "limitation" and each.name not in ABOVE]
    return TEXT("limitations", **by_machine(sentences))


def campaign_page(store: Store, contents: str) -> Part:
    """The whole page; contents: the list of the other pages. Times are those of its last block."""
    parts = {"origin": origin(store), "refusals": refusals(store), "completeness": completeness(store)}
    failed = [each for each in store.planned if each.ended in ("wrong", "not-converged", "cap-hit")]
    parts |= {"unfinished": TEXT("unfinished", cells=failed) if failed else Part("None.")}
    pages = f"## Pages\n\n{contents}" if contents else ""
    named = {"title": INDEX_TITLE, "store": store, "pages": pages}
    return TEXT("campaign", **named, sequences=_sequences(store), groups=_groups(store), **parts)


def _sequences(store: Store) -> Part:
    """A row for each sequence and reference."""
    own = store.rows("convergence", ladder="")
    if own.empty:
        return Part("No request was solved and analysed on 3 meshes or more.")
    known = store.table("convergence_errors")
    known = known.assign(known=known["value"])[["sequence", "known", "kind", "error", "model_part"]]
    meshes = own.groupby("sequence")["mesh"].agg(", ".join).rename("meshes")
    finest = own.drop_duplicates("sequence", keep="last").join(meshes, on="sequence")
    sequences = finest.merge(known, how="left", on="sequence")
    sequences["off"] = sequences["error"].where(sequences["limit"].isna(), sequences["model_part"])
    return TEXT("sequences", rows=sequences)


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
