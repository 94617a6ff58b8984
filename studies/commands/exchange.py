"""``footprint export``: a scene as a file for another program; ``footprint judge-field``: what that has found for it.

Formats and their judges are in :mod:`studies.exchange`; nothing is read or judged here.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from studies.ask.request import UsageError
from studies.commands import FAILED, NOT_CONVERGED, OK
from studies.commands.options import add_model, add_settings, check_file, named, pairs
from studies.exchange.deck import write_deck
from studies.exchange.of_scene import problem_of
from studies.exchange.problem import Problem, isotropic
from studies.exchange.sheet import write_body, write_sheet
from studies.output.atomic import write_by
from studies.output.terminal import columns

if TYPE_CHECKING:
    from studies.exchange.judging import Comparison


FORMATS = {"inp": write_deck, "vtu": write_body, "json": write_sheet}
ALIGNED = np.deg2rad(1.0)  # cords of 500 MPa in rubber of G = 2 MPa are 6 % softer 1 degree off their wall


def add_problem(parser: argparse.ArgumentParser) -> None:
    """The scene and how it is cut into bricks; the same for what is written and for what comes back."""
    parser.add_argument("scene", help="a scene of footprint list scenes")
    parser.add_argument("--measure", default="exact", help="linear for small displacements, any other for large ones")
    parser.add_argument("--mesh", help="N1xN2 bricks along a1 and a2; default that of the scene")
    parser.add_argument("--through", type=int, default=1, metavar="N", help="bricks through each ply of a shell")
    add_model(parser)
    add_settings(parser)


def problem_asked(options: argparse.Namespace) -> Problem:
    """The problem of the options; raises UsageError."""
    how = named(options, "measure", "model")
    return problem_of(options.scene, pairs(options.settings), options.mesh, options.through, **how)


def add_export(parser: argparse.ArgumentParser) -> None:
    """The problem, the format and the file."""
    add_problem(parser)
    parser.add_argument(
        "--format", required=True, choices=FORMATS, help="a deck of CalculiX, a mesh, or a neutral sheet"
    )
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help="file to write")


def run_export(options: argparse.Namespace) -> int:
    """Write the file, whole or not at all."""
    check_file(options.out)
    problem = problem_asked(options)
    write_by(options.out, lambda path: FORMATS[options.format](path, problem))
    bricks = problem.bricks
    print(f"{len(bricks.x)} nodes, {len(bricks.elements)} bricks, {len(problem.steps)} steps: {options.out}")
    if options.format == "inp" and not all(isotropic(ply) for ply in problem.materials) and bricks.turning > ALIGNED:
        turn = f"{np.rad2deg(bricks.turning):.2g} deg"
        print(f"each brick has one ply direction, the axes turn by up to {turn} from it: cords soften, refine --mesh")
    return OK


HEAD = ("load", "quantity", "found", "against", "value", "difference", "allowed", "")


def add_judge_field(parser: argparse.ArgumentParser) -> None:
    """The problem as it was exported, the file, our mesh and the tolerance."""
    add_problem(parser)
    parser.add_argument("results", type=Path, metavar="FILE", help="CSV of a field or of a curve, or .dat of CalculiX")
    parser.add_argument("--ours", metavar="N1xN2", help="mesh of our solution; default that of the bricks")
    parser.add_argument("--tolerance", default="1%", help="allowed relative difference, default 1%%")


def run_judge_field(options: argparse.Namespace) -> int:
    """Compare and print; 1 where a difference is larger than allowed."""
    from studies.exchange.judging import compared, our_solution
    from studies.exchange.results import read_results
    from studies.solving.refinement.error_control import parse_error

    tolerance = parse_error(options.tolerance)
    problem = problem_asked(options)
    results = read_results(options.results, problem)
    how = named(options, "measure", "model")
    ours = our_solution(problem, [each.load for each in results], pairs(options.settings), options.ours, **how)
    if not ours.outcome.converged:
        print(f"footprint: our solution did not converge: {ours.reason}", file=sys.stderr)
        return NOT_CONVERGED
    rows = compared(problem, results, ours, tolerance)
    if not rows:
        raise UsageError(f"{options.results} has no quantity of {options.scene}, no field of all its nodes, no balance")
    print("\n".join(columns([HEAD, *map(_words, rows)])))
    beyond = sum(not row.within for row in rows)
    print(f"{len(rows) - beyond} of {len(rows)} within what is allowed")
    return FAILED if beyond else OK


def _words(row: Comparison) -> tuple[str, ...]:
    numbers = f"{row.found:.6g}", row.against, f"{row.value:.6g}", f"{100 * row.difference:+.3f} %"
    return (f"{row.load:g}", row.quantity, *numbers, f"{100 * row.allowed:.3g} %", "" if row.within else "beyond")
