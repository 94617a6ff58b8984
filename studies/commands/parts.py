"""``footprint list`` and ``show``: what there is, and what it means; ``footprint card``: one part on a page.

The card of a part says which laws it keeps, what it claims and what it costs.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from contact.catalogue import ALGORITHMS
from formulations.strains.catalogue import MEASURES
from studies.ask.request import UsageError
from studies.catalogue.descriptions import describe, meaning_of
from studies.commands import FAILED, OK
from studies.commands.options import progress_bar
from studies.output.atomic import write_text
from studies.output.provenance import provenance
from studies.output.terminal import columns
from studies.scenes import SCENES

if TYPE_CHECKING:
    from studies.arena.card.card import Card


def add_list(parser: argparse.ArgumentParser) -> None:
    """Which catalogue."""
    parser.add_argument(
        "what", nargs="?", choices=("scenes", "measures", "algorithms", "campaigns"), help="one catalogue; default all"
    )


def run_list(options: argparse.Namespace) -> int:
    """Print one catalogue, or all."""
    from studies.run.campaign import find, names

    catalogues: dict[str, Iterable[str]] = {"scenes": SCENES, "measures": MEASURES, "algorithms": ALGORITHMS}
    lists = {what: [(name, meaning_of(name)) for name in catalogue] for what, catalogue in catalogues.items()}
    lists["campaigns"] = [(name, find(name).title) for name in names()]
    for what in [options.what] if options.what else lists:
        if not options.what:
            print(f"{what}:")
        print("\n".join(columns(lists[what], "" if options.what else "  ")))
    return OK


def add_show(parser: argparse.ArgumentParser) -> None:
    """The name."""
    parser.add_argument("name", metavar="SCENE|MEASURE|ALGORITHM", help="a name of footprint list")


def run_show(options: argparse.Namespace) -> int:
    """Print its description."""
    print(describe(options.name).text)
    return OK


def add_card(parser: argparse.ArgumentParser) -> None:
    """The file, or a part of ours, and where its page goes."""
    parser.add_argument(
        "part", nargs="?", metavar="FILE.py|NAME", help="a file with your own parts, or the name of a shipped part"
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        metavar="DIR|FILE.md",
        help="page to write; default card-NAME.md in this directory",
    )
    parser.add_argument("--check", action="store_true", help="exit 1 if a law, an answer or a claim is wrong")
    parser.add_argument("--template", type=Path, metavar="DIR", help="write a template repository for a part")


def run_card(options: argparse.Namespace) -> int:
    """Write the page and its picture, and print the verdict."""
    from reports.arena_pages import card_page
    from studies.arena.card.card import card_of
    from studies.arena.card.runs import subjects, write_layout

    if (options.part is None) == (options.template is None):
        raise UsageError("card takes one of FILE.py, NAME and --template DIR")
    if options.template is not None:
        print("\n".join(map(str, write_layout(options.template))))
        return OK
    asked = options.part
    card_subjects = subjects(asked)
    target = _target(options.out, card_subjects[0].name if len(card_subjects) == 1 else Path(asked).stem)
    with progress_bar("card") as bar:
        cards = [card_of(subject, lambda label: bar(0, 0, label)) for subject in card_subjects]
    picture = _picture(cards[0], target)
    made = provenance()
    version = f"{made['version']} at {str(made['commit'])[:12]}" if made.get("commit") else str(made["version"])
    write_text(target, card_page([card.told for card in cards], f"footprint card {asked}", version, picture))
    for card in cards:
        print(card.verdict)
    print(f"{target}, {picture}")
    return FAILED if options.check and not all(card.passes for card in cards) else OK


def _target(out: Path, name: str) -> Path:
    """The file that is asked for, its directory made; raises UsageError for a file of another kind."""
    path = out if out.suffix == ".md" else out / f"card-{name.replace(' ', '-').replace(',', '')}.md"
    if path.is_dir() or (out.suffix != ".md" and out.exists() and not out.is_dir()):
        raise UsageError(f"--out {out} must be a directory, or a file that ends in .md")
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def _picture(card: Card, page_file: Path) -> str:
    """Of the first part, beside the page; its name."""
    from reports.figures.comparisons import cost_ratios

    path = page_file.with_suffix(".svg")
    write_text(path, cost_ratios(card.drawn, card.subject.name, card.reference)())
    return path.name
