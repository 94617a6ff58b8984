"""``footprint bench``: what all that a solve does costs, one iteration and its growth, the harness, peers, solvers.

How a thing is measured is in :mod:`studies.bench` and :mod:`studies.arena`; no clock is read here.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from studies.ask.request import UsageError
from studies.commands import FAILED, NOT_CONVERGED, OK
from studies.commands.bench_solvers import add_solvers
from studies.commands.options import add_store, count, progress_bar

ROUNDS = 3


def add_bench(parser: argparse.ArgumentParser) -> None:
    """One subcommand a table; without one, the costs of all that a solve does, with their bars."""
    parser.set_defaults(bench=_costs)
    parser.add_argument("--rounds", type=int, default=ROUNDS, help="interleaved rounds, of which medians are taken")
    names = "newton|scaling|overhead|peers|programs|solvers"
    tables = parser.add_subparsers(metavar=names, parser_class=type(parser))

    newton = tables.add_parser("newton", help="one Newton step on one mesh")
    newton.add_argument("--mesh", default="42x40", metavar="N1xN2", help="mesh of the tyre")
    newton.set_defaults(bench=_scaling)

    scaling = tables.add_parser("scaling", help="one Newton step from 2,000 to a million unknowns")
    scaling.add_argument("--mesh", metavar="N1xN2,...", help="meshes, comma-separated")
    scaling.set_defaults(bench=_scaling)

    tables.add_parser("overhead", help="cost of running a cell in addition to solving it").set_defaults(bench=_overhead)

    peers = tables.add_parser("peers", help="other programs beside shells")
    peers.add_argument("--only", metavar="PROBLEM", help="one problem, e.g. hemisphere")
    peers.add_argument("--rounds", type=int, default=ROUNDS, help="interleaved rounds, of which medians are taken")
    peers.add_argument("--table", type=Path, metavar="FILE", help="write the table as CSV")
    peers.set_defaults(bench=_peers)

    programs = tables.add_parser("programs", help="CalculiX on exported decks, scene by scene; resumes")
    programs.add_argument("--only", metavar="CASE", help="one case, e.g. hemisphere")
    add_store(programs)
    programs.set_defaults(bench=_programs)

    add_solvers(tables.add_parser("solvers", help="which solvers solve frozen contact problems, and how well"))


def run_bench(options: argparse.Namespace) -> int:
    """Measure and print one table."""
    return int(options.bench(options))


def _costs(options: argparse.Namespace) -> int:
    from studies.bench.costs import BROKEN, VARIES, costs, shown

    rounds = count("rounds", options.rounds)
    with progress_bar("costs") as advance:
        table = costs(rounds, advance)
    print(f"processor time in units of one work, medians of {rounds} rounds [lowest, highest]")
    print(shown(table))
    undecided = int((table["holds"] == VARIES).sum())
    if undecided:
        print(f"{undecided} bars undecided, rounds lie on both sides: a quiet machine, or more --rounds")
    return FAILED if (table["holds"] == BROKEN).any() else OK


def _overhead(options: argparse.Namespace) -> int:
    from studies.bench.newton import beside_solving, harness

    costs = harness()
    print(beside_solving(costs))
    return OK if all(cost.kept for cost in costs) else FAILED


def _scaling(options: argparse.Namespace) -> int:
    from studies.bench.newton import MESHES, request_of, scaling, shown

    meshes = options.mesh.split(",") if options.mesh else MESHES
    for mesh in meshes:
        request_of(mesh)  # what is wrong is said before the bar is drawn
    with progress_bar("scaling") as advance:
        table = scaling(meshes, advance)
    print("one Newton step in contact, tyre, element paper, model full, shortest processor times in ms")
    print(shown(table))
    return OK


def _peers(options: argparse.Namespace) -> int:
    from studies.bench.peers import available, measured, shown, unit_of
    from studies.output.atomic import write_table

    rounds = count("rounds", options.rounds)
    lines, skipped = available()
    if not lines:
        raise UsageError("peers need the extra peers: pip install -e '.[peers]' in the checkout of Footprint")
    chosen = [line for line in lines if options.only in (None, line.problem)]
    if not chosen:
        names = ", ".join(dict.fromkeys(line.problem for line in lines))
        raise UsageError(f"--only {options.only!r} must be one of {names}")
    print("".join(f"{why}\n" for why in skipped), end="")
    with progress_bar("peers") as advance:
        table = measured(chosen, unit_of(), rounds, advance)
    if options.table is not None:
        write_table(options.table, table)
    print("medians of processor time; one unit: factorisation of 9840 unknowns by SuperLU")
    print(shown(table))
    return NOT_CONVERGED if table["value"].isna().any() else OK


def _programs(options: argparse.Namespace) -> int:
    from studies.bench.peers import CASES
    from studies.bench.programs import OPEN, TABLE, measured, shown
    from studies.output.atomic import write_table

    chosen = [case for case in CASES if options.only in (None, case.name)]
    if not chosen:
        names = ", ".join(repr(case.name) for case in CASES)
        raise UsageError(f"--only {options.only!r} must be one of {names}")
    with progress_bar("programs") as advance:
        table = measured(chosen, options.store, advance)
    if options.only is None:
        write_table(options.store / "tables" / f"{TABLE}.csv", table)
    print(shown(table))
    return FAILED if (table["reason"] == OPEN).any() else OK
