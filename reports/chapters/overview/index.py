"""The first page: what to use, why, how sure that is, a picture, and the other pages."""

from __future__ import annotations

from reports.chapter import INDEX_TITLE
from reports.chapters.catalogue.sheets import filmstrip_of
from reports.chapters.catalogue.words import NEEDS, Catalogue
from reports.chapters.contact.algorithms import when_not_table
from reports.chapters.contact.costs import costs_picture
from reports.chapters.overview.decision import decision_part, limits_part, measures_picture
from reports.chapters.tyre.page import model_table, patch_picture
from reports.markdown import Part
from reports.origin import origin
from reports.store.statements import by_machine, statements
from reports.store.tables import Store
from reports.template import Template

TEXT = Template("index")
STRAINS = ("measures-small", "measures-large", "measures-contact", "measures-cost", "cheapest-measure", "tyre-measure")
CONTACT = ("which-algorithm", "trial-and-error-ends", "false-solved", "epsilon-range")
SPARED = ("parts-of-the-tyre", "grids-of-the-tyre", "one-per-cent")
FORCE = ("force-known", "printed-excluded", "origin-of-travel")
SURE = ("convergence", "manufactured", "algorithms-agree", "symmetry", "random-cases", "advice")
ABOVE = (*FORCE, "tyre-mesh-and-load")  # limitations that stand there


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
        "tyre": _tyre(store),
    }
    counts = {"requests": len(store.planned), "scenes": len({cell.scene for cell in store.planned})}
    return TEXT("page", title=INDEX_TITLE, **counts, **sections, contents=contents, origin=origin(store))


def _section(title: str, store: Store, names: tuple[str, ...], more: Part | str = "") -> Part:
    """Sentences by their names, in order, those that depend on the machine marked; nothing where there are none."""
    by_name = {each.name: each for each in statements(store)}
    told = [by_name[name] for name in names if name in by_name]
    return TEXT("section", title=title, **by_machine(told), more=more) if told else Part()


def limitations(store: Store) -> Part:
    """What does not hold, as computed, and what is not covered at all."""
    found = [each for each in statements(store) if each.role == "limitation" and each.name not in ABOVE]
    return TEXT("limitations", **by_machine(found))


def _tyre(store: Store) -> Part:
    """In space at growing travel; its patch, where no cell of the sheets was solved."""
    strip = filmstrip_of(Catalogue.of(store)) if all(map(store.has, NEEDS)) else Part()
    return strip if strip.text else patch_picture(store)
