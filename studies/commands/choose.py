"""``footprint choose``: which measure, algorithm, element and mesh is enough on a scene of the reader's own."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from studies.answers import write_choice
from studies.commands import INTERRUPTED, NOT_CONVERGED, OK
from studies.commands.options import add_settings, add_solving, check_directory, named, of_file, pairs, progress_line
from studies.output.terminal import columns
from studies.solving.choice import Choice
from studies.solving.choose import BUDGET, ERROR, choose
from studies.solving.offers import FASTER, Offer
from studies.solving.refinement.cascade import parse_budget
from studies.solving.refinement.error_control import parse_error


def add_choose(parser: argparse.ArgumentParser) -> None:
    """The scene, the error, the budget, and where the answer goes."""
    parser.add_argument("--error", default=ERROR, metavar="E", help=f"relative error, default {ERROR}%")
    parser.add_argument("--of", metavar="QUANTITY", help="quantity; default the force, or the first one of the scene")
    parser.add_argument("--budget", default=f"{BUDGET:g}s", metavar="SECONDS", help=f"wall time, default {BUDGET:g}s")
    mesh = "N1xN2, the coarsest grid; default a quarter of that of the scene"
    add_solving(parser, "reference algorithm; default semismooth", mesh)
    add_settings(parser)
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="directory of the answer")


def run_choose(options: argparse.Namespace) -> int:
    """Choose, write and print; 3 where nothing is surely within the error. What is interrupted writes nothing."""
    check_directory(options.out)
    error, budget = parse_error(options.error), parse_budget(options.budget)
    how = named(options, "contact", "newton", "model", "steps")
    given = pairs(options.settings)
    try:
        with (
            of_file(options.scene, options.settings),
            np.errstate(over="ignore", invalid="ignore"),
            progress_line(budget) as tell,
        ):
            choice = choose(options.scene, given, error, budget, options.of, tell, options.mesh, **how)
    except KeyboardInterrupt:
        print("footprint: interrupted; nothing is written", file=sys.stderr)
        return INTERRUPTED
    write_choice(choice, options.out)
    print("\n".join(lines(choice)))
    return OK if choice.recommended is not None else NOT_CONVERGED


def lines(choice: Choice) -> Iterator[str]:
    """The answer for a terminal."""
    percent = f"{100 * choice.question.error:g} %"
    truth = choice.truth
    if truth is not None:
        known = f"{truth.limit:.6g} +- {_percent(truth.uncertainty)}"
        wall = f" with surfaces={choice.wall.name}" if choice.wall.name else ""
        asked = f"{choice.question.name}, {choice.quantity} within {percent}"
        yield f"{asked}; the exact measure{wall} in the limit: {known}"
        yield from _table(choice.variants, _variant)
    if choice.algorithms:
        yield "contact algorithms, each solved from rest and judged:"
        yield from _table(choice.trials, _trial)
    for name, offer in (("recommended", choice.recommended), ("runner-up", choice.runner_up)):
        if offer is not None:
            yield from _offer(name, offer)
    if choice.recommended and choice.runner_up and choice.runner_up.seconds < choice.recommended.seconds:
        yield f"  quicker, but a change of the request must save {100 * (1 - FASTER):.0f} %, loading included"
    yield from (f"uncertain: {sentence}" for sentence in choice.uncertain)
    yield f"{choice.seconds:.3g} s of {choice.budget:g} s"
    if choice.reason:
        yield f"no recommendation: {choice.reason}"


def _offer(name: str, offer: Offer) -> Iterator[str]:
    took = "from rest" if offer.holds else "foreseen"
    yield f"{name}: {offer.words}: error at most {_percent(offer.error_at_most)}, {offer.seconds:.3g} s {took}"
    yield f"  {offer.command}"


def _table(rows: Sequence[Mapping[str, Any]], shown: Any) -> Iterator[str]:
    formatted = [shown(row) for row in rows]
    yield from columns([list(formatted[0]), *(list(row.values()) for row in formatted)], "  ")


def _variant(row: Mapping[str, Any]) -> dict[str, str]:
    apart = row["formulation_error"]
    limit = "-" if apart is None else f"{100 * apart:+.3g} +- {_percent(row['within'])}"
    return {
        "axis": row["axis"],
        "name": row["name"] + (f", surfaces={row['surfaces']}" if row["surfaces"] else ""),
        "formulation error": limit,
        "settled": {None: "-", True: "yes", False: "no"}[row["settled"]],
        "verdict": row["verdict"],
        "mesh": row["mesh"] or "-",
        "error at most": "-" if row["error_at_most"] is None else _percent(row["error_at_most"]),
        "path [s]": "-" if row["path_seconds"] is None else f"{row['path_seconds']:.2g}",
        "": row["said"],
    }


def _trial(row: Mapping[str, Any]) -> dict[str, str]:
    return {
        "algorithm": row["name"],
        "mesh": row["mesh"],
        "outcome": row["ended"],
        "agrees": {None: "-", True: "yes", False: "no"}[row["agrees"]],
        "seconds": f"{row['seconds']:.3g}",
        "iterations": str(row["newton_iterations"]),
        "": row["said"],
    }


def _percent(value: float) -> str:
    return f"{100 * value:.2g} %"
