"""``footprint advise``: the cheapest configuration of a scene that meets a tolerance."""

from __future__ import annotations

import argparse

from studies.analysis.advise import advise, asked_question, lines
from studies.analysis.collect import collect
from studies.analysis.verify import verified
from studies.commands import FAILED, OK
from studies.commands.options import add_settings, add_store, pairs
from studies.error_control import parse_error


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The question and the campaign that answers it."""
    parser.add_argument("scene")
    parser.add_argument("--error", required=True, metavar="E", help="relative, e.g. 1%%")
    parser.add_argument("--quantity", metavar="NAME", help="e.g. force_N; default: the first one of the scene")
    add_store(parser)
    parser.add_argument("--campaign", default="standard", help="default standard")
    parser.add_argument("--cost", default="seconds", help="dofs, factorisations, flops or seconds; default seconds")
    add_settings(parser)


def run(options: argparse.Namespace) -> int:
    """Print the advice; 1 where nothing meets the tolerance."""
    tolerance, given = parse_error(options.error), pairs(options.settings)
    table = collect(options.store, options.campaign)
    question = asked_question(table, verified(table), options.scene, options.quantity, given, options.cost)
    found = advise(question, tolerance)
    print("\n".join(lines(found)))
    return OK if found.best is not None else FAILED
