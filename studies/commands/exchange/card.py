"""``footprint card``: what a newcomer adds, which laws it keeps, what it claims and what it costs, on one page."""

from __future__ import annotations

import argparse
from pathlib import Path

from studies.arena.card.card import Card, card_of
from studies.arena.card.page import drawn, page
from studies.arena.card.runs import subjects, write_layout
from studies.ask.scene import UsageError
from studies.commands import FAILED, OK
from studies.commands.options import progress_bar
from studies.output.atomic import write_text


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The file, or a part of ours, and where its page goes."""
    parser.add_argument("part", nargs="?", metavar="FILE.py", help="a file with parts, or the name of a part of ours")
    parser.add_argument("--of", metavar="NAME", help="a part of ours by its name")
    parser.add_argument("--out", type=Path, default=Path(), metavar="DIR|FILE.md", help="default card-NAME.md here")
    parser.add_argument("--check", action="store_true", help="exit 1 where a law, an answer or a claim is wrong")
    parser.add_argument("--template", type=Path, metavar="DIR", help="write the layout of a repository that has one")


def run(options: argparse.Namespace) -> int:
    """Write the page and its picture, and print the verdict."""
    if sum(given is not None for given in (options.part, options.of, options.template)) != 1:
        raise UsageError("card takes one of FILE.py, --of NAME and --template DIR")
    if options.template is not None:
        print("\n".join(map(str, write_layout(options.template))))
        return OK
    asked = options.part or options.of
    found = subjects(asked)
    target = _target(options.out, found[0].name if len(found) == 1 else Path(asked).stem)
    with progress_bar("card") as bar:
        cards = [card_of(subject, lambda label: bar(0, 0, label)) for subject in found]
    picture = _picture(cards[0], target)
    write_text(target, page(cards, f"footprint card {asked}", picture))
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
    write_text(path, cost_ratios(drawn(card), card.subject.name, card.reference)())
    return path.name
