"""The pages of a store: rendered as a whole, then written, or compared with the ones that are committed.

Each page is a function of the store; no page is written before all are rendered. Beside them, all pages in one HTML.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from reports import labels
from reports.chapters.contact.agreement import agreement_page
from reports.chapters.contact.algorithms import algorithms_page
from reports.chapters.contact.epsilon import epsilon_page
from reports.chapters.limits.extremes import extremes_page
from reports.chapters.limits.symmetry import symmetry_page
from reports.chapters.overview.campaign import campaign_page
from reports.chapters.overview.index import index_page
from reports.chapters.overview.outcomes import completeness_line
from reports.chapters.shells.benchmarks import benchmarks_page
from reports.chapters.shells.convergence import convergence_page
from reports.chapters.shells.locking import locking_page
from reports.chapters.shells.measures import measures_page
from reports.chapters.shells.rigid_body import rigid_body_page
from reports.chapters.trade.advice import NEEDED as ADVICE_TABLES
from reports.chapters.trade.advice import advice_page
from reports.chapters.trade.cost import cost_page
from reports.chapters.trade.tradeoff import NEEDED as TRADEOFF_TABLES
from reports.chapters.trade.tradeoff import tradeoff_page
from reports.chapters.tyre.page import tyre_page
from reports.compare import differences
from reports.files import write_texts
from reports.html import REPORT, report_html
from reports.markdown import Part
from reports.tables import Store, load_store

PAGES: Mapping[str, Callable[[Store], Part]] = {
    "index.md": index_page,
    "tyre.md": tyre_page,
    "benchmarks.md": benchmarks_page,
    "convergence.md": convergence_page,
    "measures.md": measures_page,
    "rigid-body.md": rigid_body_page,
    "locking.md": locking_page,
    "symmetry.md": symmetry_page,
    "extremes.md": extremes_page,
    "contact-agreement.md": agreement_page,
    "algorithms.md": algorithms_page,
    "epsilon.md": epsilon_page,
    "cost.md": cost_page,
}
CAMPAIGN_PAGES: Mapping[str, Callable[[Store], Part]] = {"index.md": campaign_page}
ANALYSIS: Mapping[str, tuple[tuple[str, ...], Callable[[Store], Part]]] = {  # with the tables they are made of
    "tradeoff.md": (TRADEOFF_TABLES, tradeoff_page),
    "advice.md": (ADVICE_TABLES, advice_page),
}
FIGURES = "figures"
ALL = "all"  # what a campaign says whose cells are those of all pages


def write_pages(store: Path, out: Path, campaign: str | None = None) -> list[Path]:
    """Render everything, then write it into ``out``; returns the paths. After a StoreError nothing is written."""
    return write_texts(out, rendered(load_store(store, campaign)))


def check_pages(store: Path, out: Path, campaign: str | None = None) -> list[str]:
    """Differences between the pages in ``out`` and those of the store, a line each; pictures need only be there."""
    return compare_pages(rendered(load_store(store, campaign)), out)


def place_of(store: Path, campaign: str | None = None) -> tuple[str, str]:
    """The folder below the pages that those of a campaign belong to, and how complete it is in one line."""
    loaded = load_store(store, campaign)
    return "" if loaded.pages == ALL else loaded.campaign, completeness_line(loaded)


def rendered(store: Store) -> dict[str, str]:
    """All files by name: pictures first, so that a page never links to one that is not there yet."""
    pages = PAGES if store.pages == ALL else CAMPAIGN_PAGES
    for delta in labels.CURVES if store.pages == ALL else ():
        store.cell(labels.PAPER).step(delta_mm=delta)
    parts = {name: page(store) for name, page in pages.items()} | analysis_pages(store)
    pictures = {name: svg for part in parts.values() for name, svg in part.pictures.items()}
    texts = {name: part.text for name, part in parts.items()}
    whole = {REPORT: report_html(texts, pictures)}
    return {f"{FIGURES}/{name}": svg for name, svg in pictures.items()} | texts | whole


def analysis_pages(store: Store) -> dict[str, Part]:
    """The pages of the analysis, those whose tables are all there."""
    there = {name: page for name, (needed, page) in ANALYSIS.items() if all(map(store.has_analysis, needed))}
    return {name: page(store) for name, page in there.items()}


def compare_pages(files: Mapping[str, str], out: Path) -> list[str]:
    """Differences between ``files`` and what is in ``out``."""
    there = {
        path.relative_to(out).as_posix()
        for path in [*out.glob("*.md"), *out.glob("*.html"), *(out / FIGURES).glob("*.svg")]
    }
    found = [f"{name}: missing in {out}" for name in files if name not in there]
    found += [f"{name}: in {out}, but no longer made" for name in sorted(there - set(files))]
    pages = [name for name in files if name.endswith(".md") and name in there]
    if not pages:
        found.append(f"{out}: no page to compare")
    for name in pages:
        found += differences(name, (out / name).read_text(encoding="utf-8"), files[name])
    return found
