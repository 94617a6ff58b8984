"""``footprint run``: the missing cells of a campaign into its store."""

from __future__ import annotations

import argparse
import sys

from studies.ask.scene import UsageError
from studies.commands import FAILED, OK
from studies.commands.options import add_store, add_trust, positive, progress_bar
from studies.fuzz import examine as fuzz
from studies.fuzz.cases import KINDS
from studies.fuzz.examine import BROKEN, command_of
from studies.run.campaign import find
from studies.run.running import run as run_campaign
from studies.run.task import Limits


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The campaign, its store, the engine and the limits of a cell."""
    parser.add_argument("campaign", help=f"a name of its own, or a .toml file; {fuzz.NAME}: random cases")
    add_store(parser)
    add_trust(parser)
    parser.add_argument("--engine", default="serial", help="serial, local:N or dask:ADDRESS; default serial")
    parser.add_argument("--resume", action="store_true", help="only go on with a campaign that the store knows")
    parser.add_argument("--fields", action="store_true", help="keep the fields of every cell, for footprint merge")
    usual, short = Limits(), fuzz.LIMITS
    told = f"of one cell, default {usual.time_s:g}; of a random case {short.time_s:g}"
    parser.add_argument("--time-limit", type=float, metavar="S", help=told)
    told = f"of one cell, default {usual.memory_MB:g}; of a random case {short.memory_MB:g}"
    parser.add_argument("--memory-limit", type=float, metavar="MB", help=told)
    parser.add_argument("--cases", type=int, metavar="N", help=f"of {fuzz.NAME}: from 0 on, default {fuzz.CASES}")
    parser.add_argument("--seeds", metavar="A:B", help=f"of {fuzz.NAME}: its cases from A on, before B")
    parser.add_argument("--kind", choices=list(KINDS), default="", help=f"of {fuzz.NAME}: of all its cases")


def run(options: argparse.Namespace) -> int:
    """Solve what is missing and print a line of what became of it."""
    if options.campaign == fuzz.NAME:
        return _run_fuzz(options)
    for name in ("cases", "seeds", "kind"):
        if getattr(options, name):
            raise UsageError(f"--{name} is of {fuzz.NAME}, not of {options.campaign}")
    limits = _limits(options, Limits())
    campaign = find(options.campaign, trust=options.trust)
    with progress_bar(campaign.name) as advance:
        summary = run_campaign(
            campaign,
            options.store,
            options.engine,
            limits,
            advance,
            lambda line: print(f"footprint: {line}", file=sys.stderr),
            resume=options.resume,
            fields=options.fields,
        )
    print(f"{campaign.name}: {summary.line}")
    if not summary.failed:
        return OK
    sys.stdout.flush()
    told = ", ".join(summary.failed)
    print(f"footprint: failed: {told}; footprint table {campaign.name} names the cells", file=sys.stderr)
    return FAILED


def _limits(options: argparse.Namespace, usual: Limits) -> Limits:
    """Those that are given, and else the usual ones."""
    time_s = usual.time_s if options.time_limit is None else options.time_limit
    memory_MB = usual.memory_MB if options.memory_limit is None else options.memory_limit
    return Limits(positive("time-limit", time_s), positive("memory-limit", memory_MB))


def _run_fuzz(options: argparse.Namespace) -> int:
    """Examine the missing random cases; a broken law is a failed check."""
    if options.fields:
        raise UsageError(f"--fields is of cells, {fuzz.NAME} has none")
    limits = _limits(options, fuzz.LIMITS)
    seeds = _seeds(options)
    with progress_bar(fuzz.NAME) as advance:
        summary = fuzz.run(options.store, seeds, options.kind, options.engine, limits, advance, resume=options.resume)
    print(f"{fuzz.NAME}: {summary.line}")
    print("\n".join(summary.lines))
    for row in summary.rows:
        if row["verdict"] == BROKEN:
            print(f"{command_of(row['seed'], row['kind'])}: {row['law']}: {row['said']}")
    return FAILED if summary.broken else OK


def _seeds(options: argparse.Namespace) -> range:
    """The numbers of the cases."""
    if options.seeds is None:
        return range(fuzz.CASES if options.cases is None else options.cases)
    first, _, end = options.seeds.partition(":")
    if options.cases is not None or not (first.isdecimal() and end.isdecimal()):
        raise UsageError(f"--seeds {options.seeds!r} must be A:B with two whole numbers, without --cases")
    return range(int(first), int(end))
