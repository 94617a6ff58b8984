"""The first page: what to use, why, how sure that is, a picture, and the other pages."""

from __future__ import annotations

from reports.chapter import INDEX_TITLE
from reports.chapters.catalogue.scene_sheet import filmstrip_of
from reports.chapters.catalogue.words import NEEDS, Catalogue
from reports.chapters.contact.algorithms import costs_table
from reports.chapters.overview.decision import (
    decision_part,
    elements_part,
    limits_part,
    measures_picture,
)
from reports.chapters.tyre.page import patch_picture
from reports.markdown import Part, joined, machine, prose
from reports.origin import origin
from reports.store.statements import sentence, statements
from reports.store.tables import Store

REGIMES = ("measures-small", "measures-large", "measures-contact")
SURE = ("force-known", "convergence", "manufactured", "algorithms-agree", "symmetry", "random-cases")


def index_page(store: Store, contents: str) -> Part:
    """The whole page; contents: the list of the other pages."""
    scenes = len({cell.scene for cell in store.planned})
    introduction = prose(f"""Interchangeable strain measures and contact algorithms on one and the same shell element:
which one a problem needs, on which mesh, and what it costs. Computed from {len(store.planned)} requests over {scenes}
scenes; the [appendix](data.md) says how many problems a sentence rests on and what a word means.""")
    head = joined(f"# {INDEX_TITLE}", introduction, decision_part(store), measures_picture(store))
    more = "[More: strain measures](measures.md)"
    measures = (*REGIMES, "measures-cost", "cheapest-measure", "tyre-measure")
    strains = _section("Exact or classical strains?", store, measures, limits_part(store), elements_part(store), more)
    more = "[When not to use each](algorithms.md#when-not-to-use-each), [more on contact algorithms](algorithms.md), "
    more += "[solved, failed, refused](data.md#solved-failed-refused)"
    contact = ("which-algorithm", "trial-and-error-ends", "false-solved", "epsilon-range")
    algorithms = _section("Which contact algorithm?", store, contact, costs_table(store), more)
    sure = _section("How sure is this?", store, (*SURE, "advice"))
    spared = _section("What does it save?", store, ("parts-of-the-tyre", "grids-of-the-tyre", "one-per-cent"))
    return joined(
        head, strains, algorithms, spared, sure, limitations(store), _tyre(store), "## Pages", contents, origin(store)
    )


def _section(title: str, store: Store, names: tuple[str, ...], *parts: Part | str) -> Part:
    """Sentences by their names, in order, those that depend on the machine marked; nothing where there are none."""
    by_name = {each.name: each for each in statements(store)}
    said = [by_name[name] for name in names if name in by_name]
    if not said:
        return Part("")
    steady = "\n".join(f"- {each.text}" for each in said if not each.machine)
    timed = "\n".join(f"- {each.text}" for each in said if each.machine)
    return joined(f"## {title}", steady, machine(timed) if timed else "", *parts)


def limitations(store: Store) -> Part:
    """What does not hold, as computed, and what is not covered at all."""
    found = [each for each in statements(store) if each.role == "limitation"]
    steady = [f"- {each.text}" for each in found if not each.machine]
    timed = [f"- {each.text}" for each in found if each.machine]
    about = sentence(store, "tyre-linear")
    steady += [f"- The paper's sentence on linear strains is not confirmed. {about}"] if about else []
    steady.append(
        "- These pages cover one shell element in static equilibrium. The obstacle is rigid, its friction Coulomb's "
        "with one coefficient; wear, rolling, dynamics and contact between two deformable bodies are not computed."
    )
    return joined("## Known limitations", "\n".join(steady), machine("\n".join(timed)) if timed else "")


def _tyre(store: Store) -> Part:
    """In space at growing travel; its patch, where no cell of the sheets was solved."""
    strip = filmstrip_of(Catalogue.of(store)) if all(map(store.has_analysis, NEEDS)) else None
    return joined("## The paper's tyre, pressed on the plane", strip or patch_picture(store))
