"""``footprint judge-field``: what another program has found for a scene."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from studies.ask.scene import UsageError
from studies.commands import FAILED, NOT_CONVERGED, OK
from studies.commands.exchange.export import add_problem, problem_asked
from studies.commands.options import named, pairs
from studies.exchange.judging import Comparison, compared, our_solution
from studies.exchange.results import read_results
from studies.output.terminal import columns
from studies.solving.refinement.error_control import parse_error

HEAD = ("load", "quantity", "found", "against", "value", "difference", "allowed", "")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The problem as it was exported, the file, our mesh and the tolerance."""
    add_problem(parser)
    parser.add_argument("results", type=Path, metavar="FILE", help="CSV of a field or of a curve, or .dat of CalculiX")
    parser.add_argument("--ours", metavar="N1xN2", help="mesh of our solution; default that of the bricks")
    parser.add_argument("--tolerance", default="1%", help="relative difference that is allowed, default 1%%")


def run(options: argparse.Namespace) -> int:
    """Compare and print; 1 where a difference is larger than allowed."""
    tolerance = parse_error(options.tolerance)
    problem = problem_asked(options)
    found = read_results(options.results, problem)
    how = named(options, "measure", "model")
    ours = our_solution(problem, [each.load for each in found], pairs(options.settings), options.ours, **how)
    if not ours.outcome.converged:
        print(f"footprint: our solution did not converge: {ours.reason}", file=sys.stderr)
        return NOT_CONVERGED
    rows = compared(problem, found, ours, tolerance)
    if not rows:
        raise UsageError(f"{options.results} has no quantity of {options.scene}, no field of all its nodes, no balance")
    print("\n".join(columns([HEAD, *map(_words, rows)])))
    beyond = sum(not row.within for row in rows)
    print(f"{len(rows) - beyond} of {len(rows)} within what is allowed")
    return FAILED if beyond else OK


def _words(row: Comparison) -> tuple[str, ...]:
    numbers = f"{row.found:.6g}", row.against, f"{row.value:.6g}", f"{100 * row.difference:+.3f} %"
    return (f"{row.load:g}", row.quantity, *numbers, f"{100 * row.allowed:.3g} %", "" if row.within else "beyond")
