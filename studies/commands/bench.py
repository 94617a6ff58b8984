"""``footprint bench``: what all that a solve does costs, one iteration and its growth, the harness, peers, solvers.

How a thing is measured is in :mod:`studies.bench` and :mod:`studies.arena`; no clock is read here.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from studies.ask.request import UsageError
from studies.commands import FAILED, NOT_CONVERGED, OK
from studies.commands.bench_solvers import add_solvers
from studies.commands.options import STORE, count, progress_bar
from studies.output.terminal import columns

MESH, REPEATS, ROUNDS = "42x40", 9, 3


def add_bench(parser: argparse.ArgumentParser) -> None:
    """One subcommand a table; without one, the costs of all that a solve does, with their bars."""
    parser.set_defaults(bench=_costs)
    parser.add_argument("--rounds", type=int, default=ROUNDS, help="interleaved rounds, of which medians are taken")
    parser.add_argument("--largest", action="store_true", help="factorise 250,000 unknowns, too")
    parser.add_argument("--table", type=Path, metavar="FILE", help="write the table as CSV")
    names = "newton|scaling|overhead|peers|programs|solvers"
    tables = parser.add_subparsers(metavar=names, parser_class=type(parser))

    newton = tables.add_parser("newton", help="cost of one Newton iteration, as ratios")
    newton.add_argument("--mesh", default=MESH, metavar="N1xN2", help="of the tyre")
    newton.add_argument("--repeats", type=int, default=REPEATS, help="of everything that is timed")
    newton.set_defaults(bench=_newton)

    scaling = tables.add_parser("scaling", help="one Newton step from 2,000 to 250,000 unknowns")
    scaling.add_argument("--mesh", metavar="N1xN2,...", help="several, comma-separated")
    scaling.add_argument("--machine", choices=("floors",), help="times over the machine's own, too")
    scaling.add_argument("--table", type=Path, metavar="FILE", help="write the table as CSV")
    scaling.set_defaults(bench=_scaling)

    overhead = tables.add_parser("overhead", help="what running and reading cost beside solving")
    overhead.add_argument("--repeats", type=int, default=REPEATS, help="of everything that is timed")
    overhead.set_defaults(bench=_overhead)

    peers = tables.add_parser("peers", help="other programs beside shells")
    peers.add_argument("--only", metavar="PROBLEM", help="one problem, e.g. hemisphere")
    peers.add_argument("--rounds", type=int, default=ROUNDS, help="interleaved rounds, of which medians are taken")
    peers.add_argument("--table", type=Path, metavar="FILE", help="write the table as CSV")
    peers.set_defaults(bench=_peers)

    programs = tables.add_parser("programs", help="CalculiX on decks of ours, scene by scene; resumes")
    programs.add_argument("--only", metavar="CASE", help="one case, e.g. hemisphere")
    programs.add_argument(
        "--store", "--out", type=Path, default=STORE, metavar="STORE", help="where results and tables go"
    )
    programs.set_defaults(bench=_programs)

    add_solvers(tables.add_parser("solvers", help="who solves frozen contact problems, and how well"))


def run_bench(options: argparse.Namespace) -> int:
    """Measure and print one table."""
    return int(options.bench(options))


def _costs(options: argparse.Namespace) -> int:
    from studies.bench.costs import costs, with_pardiso
    from studies.bench.rounds import BROKEN, VARIES, shown
    from studies.output.atomic import write_table

    rounds = count("rounds", options.rounds)
    with progress_bar("costs") as advance:
        table = costs(rounds, options.largest, advance)
    if options.table is not None:
        write_table(options.table, table)
    print(f"processor time in units of one work, medians of {rounds} rounds [lowest, highest]")
    if not with_pardiso():
        print("PARDISO: skipped, needs the extra mkl")
    print("\n".join(shown(table)))
    undecided = int((table["holds"] == VARIES).sum())
    if undecided:
        print(f"{undecided} bars undecided, rounds lie on both sides: a quiet machine, or more --rounds")
    return FAILED if (table["holds"] == BROKEN).any() else OK


def _newton(options: argparse.Namespace) -> int:
    from studies.bench.newton import bench

    dofs, seconds = bench(options.mesh, repeats=count("repeats", options.repeats))
    print(f"one Newton iteration, tyre {options.mesh}, {dofs} dofs, medians of {options.repeats}")
    rows = [(part, f"{1e3 * s:.2f}", f"{s / seconds['factorisation']:.3f}") for part, s in seconds.items()]
    print("\n".join(columns([("part", "ms", "/ factorisation"), *rows], right=range(1, 3))))
    return OK


def _overhead(options: argparse.Namespace) -> int:
    from studies.bench.overhead import harness, lines

    costs = harness(count("repeats", options.repeats))
    print("\n".join(lines(costs)))
    return OK if all(cost.kept for cost in costs) else FAILED


def _scaling(options: argparse.Namespace) -> int:
    from studies.bench.newton import MESHES, lines, request_of, scaling
    from studies.output.atomic import write_table

    meshes = options.mesh.split(",") if options.mesh else MESHES
    for mesh in meshes:
        request_of(mesh)  # what is wrong is said before the bar is drawn
    with progress_bar("scaling") as advance:
        table = scaling(meshes, advance)
    if options.table is not None:
        write_table(options.table, table)
    print("one Newton step in contact, tyre, element paper, model full, shortest processor times in ms")
    print("\n".join(lines(table, floors=options.machine == "floors")))
    return OK


def _peers(options: argparse.Namespace) -> int:
    from studies.bench.peers import available, lines_of, measured, unit_of
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
    print("\n".join(lines_of(table)))
    return NOT_CONVERGED if table["value"].isna().any() else OK


def _programs(options: argparse.Namespace) -> int:
    from studies.bench.peers import CASES
    from studies.bench.programs import OPEN, TABLE, lines_of, measured
    from studies.output.atomic import write_table

    chosen = [case for case in CASES if options.only in (None, case.name)]
    if not chosen:
        names = ", ".join(repr(case.name) for case in CASES)
        raise UsageError(f"--only {options.only!r} must be one of {names}")
    with progress_bar("programs") as advance:
        table = measured(chosen, options.store, advance)
    if options.only is None:
        write_table(options.store / "tables" / f"{TABLE}.csv", table)
    print("\n".join(lines_of(table)))
    return FAILED if (table["reason"] == OPEN).any() else OK
