"""``footprint advise``: the cheapest configuration of a scene that meets a tolerance."""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Iterator
from pathlib import Path

from studies.analysis.advice.choose import advise, lines, question_of, worth
from studies.analysis.advice.questions import Question
from studies.analysis.shell_limits import beyond, known_limits
from studies.ask.request import Settings, text_of
from studies.ask.scene import UsageError
from studies.commands import FAILED, OK
from studies.commands.options import STORE, add_settings, pairs, reading
from studies.run.archive import Archive
from studies.scenes import SCENES
from studies.scenes.complete import complete
from studies.scenes.plugins import use_options
from studies.solving.refinement.error_control import parse_error

SHIPPED = "standard"


def add_advise(parser: argparse.ArgumentParser) -> None:
    """The question and the campaign that answers it."""
    parser.add_argument("scene", help="a scene of footprint list scenes")
    parser.add_argument("--error", required=True, metavar="E", help="relative error, e.g. 1%%")
    parser.add_argument("--quantity", metavar="NAME", help="quantity, e.g. force_N; default the first one of the scene")
    help_text = f"store of the campaign; default {STORE} if it has the campaign, else the shipped campaign {SHIPPED}"
    parser.add_argument("--store", type=Path, metavar="DIR", help=help_text)
    parser.add_argument("--campaign", default=SHIPPED, help="campaign whose cells are compared")
    parser.add_argument("--cost", default="seconds", help="cost: dofs, seconds or operations; default seconds")
    add_settings(parser)


def run_advise(options: argparse.Namespace) -> int:
    """Print the advice; 1 where nothing meets the tolerance.

    Whether a shell is enough at all is said first: that takes no campaign, so it is known of a scene without one, too.
    """
    tolerance, given, store = parse_error(options.error), pairs(options.settings), _store(options)
    try:
        question = _asked(options, given, store)
    except UsageError as error:
        if options.scene not in SCENES:
            raise
        _say_limit(options, complete(options.scene, given)[1].settings, tolerance)
        raise UsageError(f"{error}; for your own settings: {_choose(options, given)}") from None
    _say_limit(options, Settings(question.values), tolerance)
    advice = advise(question, tolerance)
    print("\n".join([*lines(advice), *filter(None, [worth(store), *_beyond(options, question, given)])]))
    return OK if advice.best is not None else FAILED


def _store(options: argparse.Namespace) -> Path | None:
    """The store that is asked; None for the shipped tables."""
    if options.store is None and options.campaign == SHIPPED and not Archive(STORE).index_path(SHIPPED).exists():
        return None
    return Path(options.store or STORE)


def _asked(options: argparse.Namespace, given: dict[str, str], store: Path | None) -> Question:
    asked = (options.scene, options.quantity, given, options.cost, store, options.campaign)
    if store is None:
        return question_of(*asked)
    with reading(store):
        return question_of(*asked)


def _beyond(options: argparse.Namespace, question: Question, given: dict[str, str]) -> Iterator[str]:
    """Where the advice goes beyond what was solved, and what answers for the reader's own settings."""
    if options.scene not in SCENES:
        return
    asked = complete(options.scene, given)[1].settings
    other = {key: text_of(asked[key]) for key in asked if key in question.settings}
    other = {key: text for key, text in other.items() if text != question.settings[key]}
    if other:
        was = " ".join(f"{key}={question.settings[key]}" for key in other)
        here = " ".join(f"{key}={text}" for key, text in other.items())
        yield f"extrapolated: solved with {was}, not with {here}"
    here = _choose(options, given)
    yield f"seconds are those of the machine that ran the campaign; for your own settings on this machine: {here}"


def _choose(options: argparse.Namespace, given: dict[str, str]) -> str:
    """The command line that answers for the reader's own settings."""
    words = [f"--of {shlex.quote(options.quantity)}"] if options.quantity else []
    words += [f"--set {shlex.quote(f'{key}={text}')}" for key, text in given.items()] + use_options()
    return " ".join(["footprint choose", options.scene, f"--error {options.error}", *words, "--out DIR"])


def _say_limit(options: argparse.Namespace, settings: Settings, tolerance: float) -> None:
    limit = beyond(options.scene, settings, options.quantity, tolerance, known_limits(options.store or STORE))
    if limit is not None:
        print(limit)
