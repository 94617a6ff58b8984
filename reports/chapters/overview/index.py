"""The first page: what to use, why, how sure that is, a picture, and the other pages."""

from __future__ import annotations

from reports.chapter import INDEX_TITLE
from reports.chapters.catalogue.scene_sheet import filmstrip_of
from reports.chapters.catalogue.words import NEEDS, Catalogue
from reports.chapters.contact.algorithms import when_not_table
from reports.chapters.contact.costs import costs_picture
from reports.chapters.overview.decision import (
    decision_part,
    limits_part,
    measures_picture,
)
from reports.chapters.tyre.budget import model_table
from reports.chapters.tyre.page import patch_picture
from reports.markdown import Part, joined, machine, prose
from reports.origin import origin
from reports.store.statements import statements
from reports.store.tables import Store

REGIMES = ("measures-small", "measures-large", "measures-contact")
SURE = ("convergence", "manufactured", "algorithms-agree", "symmetry", "random-cases", "advice")
FORCE = ("force-known", "printed-excluded", "origin-of-travel")
ABOVE = (*FORCE, "tyre-mesh-and-load")  # limitations that stand there
OTHERS = """- Other finite-element programs are not part of a campaign: where they are installed `footprint bench peers`
times NGSolve and Kratos, and `footprint bench programs` runs CalculiX on our decks; both write a page."""


def index_page(store: Store, contents: str) -> Part:
    """The whole page; contents: the list of the other pages."""
    scenes = len({cell.scene for cell in store.planned})
    introduction = prose(f"""Interchangeable strain measures and contact algorithms on one and the same shell element:
which one a problem needs, on which mesh, and what it costs. Computed from {len(store.planned)} requests over {scenes}
scenes; the [appendix](data.md) says how many problems a sentence rests on and what a word means.""")
    head = joined(f"# {INDEX_TITLE}", introduction, decision_part(store), measures_picture(store))
    more = "[More: strain measures](measures.md)"
    measures = (*REGIMES, "measures-cost", "cheapest-measure", "tyre-measure")
    strains = _section("Exact or classical strains?", store, measures, limits_part(store), more)
    more = "More: [contact algorithms](algorithms.md), [solved, failed, refused](data.md#solved-failed-refused)"
    contact = ("which-algorithm", "trial-and-error-ends", "false-solved", "epsilon-range")
    algorithms = _section("Which contact algorithm?", store, contact, when_not_table(), costs_picture(store), more)
    force = _section("What is the tyre's force worth?", store, FORCE, model_table(store))
    sure = _section("How sure is this?", store, SURE, prose(OTHERS))
    spared = _section("What does it save?", store, ("parts-of-the-tyre", "grids-of-the-tyre", "one-per-cent"))
    return joined(
        *(head, strains, algorithms, spared, force, sure, limitations(store), _tyre(store)),
        *("## Pages", contents, origin(store)),
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
    found = [each for each in statements(store) if each.role == "limitation" and each.name not in ABOVE]
    steady = [f"- {each.text}" for each in found if not each.machine]
    timed = [f"- {each.text}" for each in found if each.machine]
    steady.append(
        "- These pages cover one shell element with its options in static equilibrium. The obstacle is rigid, its "
        "friction Coulomb's with one coefficient; wear, rolling tyres, dynamics and contact between two deformable "
        "bodies are not computed."
    )
    return joined("## Known limitations", "\n".join(steady), machine("\n".join(timed)) if timed else "")


def _tyre(store: Store) -> Part:
    """In space at growing travel; its patch, where no cell of the sheets was solved."""
    strip = filmstrip_of(Catalogue.of(store)) if all(map(store.has_analysis, NEEDS)) else None
    return joined("## The paper's tyre, pressed on the plane", strip or patch_picture(store))
