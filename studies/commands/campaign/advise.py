"""``footprint advise``: the cheapest configuration of a scene that meets a tolerance."""

from __future__ import annotations

import argparse

from studies.analysis.advise import Question, advise, asked_question, lines
from studies.analysis.collect import collect
from studies.analysis.shell_limits.beyond import beyond, known_limits
from studies.analysis.verify import verified
from studies.commands import FAILED, OK
from studies.commands.options import add_settings, add_store, pairs
from studies.complete import complete
from studies.error_control import parse_error
from studies.request import Settings
from studies.scene import UsageError
from studies.scenes import SCENES


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The question and the campaign that answers it."""
    parser.add_argument("scene")
    parser.add_argument("--error", required=True, metavar="E", help="relative, e.g. 1%%")
    parser.add_argument("--quantity", metavar="NAME", help="e.g. force_N; default: the first one of the scene")
    add_store(parser)
    parser.add_argument("--campaign", default="standard", help="default standard")
    parser.add_argument("--cost", default="seconds", help="dofs, seconds or operations; default seconds")
    add_settings(parser)


def run(options: argparse.Namespace) -> int:
    """Print the advice; 1 where nothing meets the tolerance.

    Whether a shell is enough at all is said first: that takes no campaign, so it is known of a scene without one, too.
    """
    tolerance, given = parse_error(options.error), pairs(options.settings)
    try:
        question = _asked(options, given)
    except UsageError:
        if options.scene in SCENES:
            _say_limit(options, complete(options.scene, given)[1].settings, tolerance)
        raise
    _say_limit(options, Settings(question.settings), tolerance)
    found = advise(question, tolerance)
    print("\n".join(lines(found)))
    return OK if found.best is not None else FAILED


def _asked(options: argparse.Namespace, given: dict[str, str]) -> Question:
    table = collect(options.store, options.campaign)
    return asked_question(table, verified(table), options.scene, options.quantity, given, options.cost)


def _say_limit(options: argparse.Namespace, settings: Settings, tolerance: float) -> None:
    limit = beyond(options.scene, settings, options.quantity, tolerance, known_limits(options.store))
    if limit is not None:
        print(limit.line)
