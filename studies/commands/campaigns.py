"""Commands on the cells of a campaign in a store: run, merge, table, time, analyse and report."""

from __future__ import annotations

import argparse
import math
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from studies.ask.request import UsageError
from studies.commands import FAILED, OK
from studies.commands.options import add_store, add_trust, count, positive, progress_bar, reading
from studies.output.atomic import write_table

if TYPE_CHECKING:
    from studies.run.task import Limits


CAMPAIGN = "of footprint list campaigns, or a .toml file that was run"


def add_run(parser: argparse.ArgumentParser) -> None:
    """The campaign, its store, the engine and the limits of a cell."""
    from studies.fuzz import examine as fuzz
    from studies.fuzz.cases import KINDS
    from studies.run.task import Limits

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


def run_run(options: argparse.Namespace) -> int:
    """Solve what is missing and print a line of what became of it."""
    from studies.fuzz.examine import NAME as FUZZ
    from studies.run.campaign import find
    from studies.run.running import run as run_campaign
    from studies.run.task import Limits

    if options.campaign == FUZZ:
        return _run_fuzz(options)
    for name in ("cases", "seeds", "kind"):
        if getattr(options, name):
            raise UsageError(f"--{name} is of {FUZZ}, not of {options.campaign}")
    limits = _limits_of(options, Limits())
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


def _limits_of(options: argparse.Namespace, usual: Limits) -> Limits:
    """Those that are given, and else the usual ones."""
    from studies.run.task import Limits

    time_s = usual.time_s if options.time_limit is None else options.time_limit
    memory_MB = usual.memory_MB if options.memory_limit is None else options.memory_limit
    return Limits(positive("time-limit", time_s), positive("memory-limit", memory_MB))


def _run_fuzz(options: argparse.Namespace) -> int:
    """Examine the missing random cases; a broken law is a failed check."""
    from studies.fuzz import examine as fuzz

    if options.fields:
        raise UsageError(f"--fields is of cells, {fuzz.NAME} has none")
    limits = _limits_of(options, fuzz.LIMITS)
    seeds = _seeds(options, fuzz.CASES)
    with progress_bar(fuzz.NAME) as advance:
        summary = fuzz.run(options.store, seeds, options.kind, options.engine, limits, advance, resume=options.resume)
    print(f"{fuzz.NAME}: {summary.line}")
    print("\n".join(summary.lines))
    for row in summary.rows:
        if row["verdict"] == fuzz.BROKEN:
            print(f"{fuzz.command_of(row['seed'], row['kind'])}: {row['law']}: {row['said']}")
    return FAILED if summary.broken else OK


def _seeds(options: argparse.Namespace, usual: int) -> range:
    """The numbers of the cases; usual: how many there are."""
    if options.seeds is None:
        return range(usual if options.cases is None else options.cases)
    first, _, end = options.seeds.partition(":")
    if options.cases is not None or not (first.isdecimal() and end.isdecimal()):
        raise UsageError(f"--seeds {options.seeds!r} must be A:B with two whole numbers, without --cases")
    return range(int(first), int(end))


def add_table(parser: argparse.ArgumentParser) -> None:
    """The campaign and which of its rows."""
    parser.add_argument("campaign", help=CAMPAIGN)
    add_store(parser)
    parser.add_argument("--where", action="append", default=[], metavar="COLUMN=VALUE", help="only these rows")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="write all columns as CSV")


def run_table(options: argparse.Namespace) -> int:
    """Print outcome, label and reason of each cell, and how many of each outcome there are."""
    from studies.run.collect import collect

    with reading(options.store):
        table = collect(options.store, options.campaign)
    for pair in options.where:
        column, separator, value = pair.partition("=")
        if not separator or column not in table:
            raise UsageError(f"--where {pair!r} must be COLUMN=VALUE with one of {', '.join(map(str, table.columns))}")
        numbers = table[column].dtype.kind == "f"
        table = table[table[column] == (_compared_number(pair, value) if numbers else value)]
    if options.csv is not None:
        write_table(options.csv, table)
    print(f"{'outcome':15s}{'cell':60s}reason")
    for outcome, label, reason in zip(table["outcome"], table["label"], table["reason"], strict=True):
        print(f"{outcome:15s}{label:60s}{'' if outcome == 'converged' else reason}".rstrip())
    print(f"{len(table)} cells: " + ", ".join(f"{n} {name}" for name, n in table["outcome"].value_counts().items()))
    return OK


def _compared_number(pair: str, value: str) -> float:
    try:
        return float(value)
    except ValueError:
        raise UsageError(f"--where {pair!r}: this column has numbers") from None


def add_time(parser: argparse.ArgumentParser) -> None:
    """The campaign, which cells and how often."""
    parser.add_argument("campaign", help=CAMPAIGN)
    add_store(parser)
    add_trust(parser)
    parser.add_argument("--only", default="", metavar="REGEX", help="the labels that are timed")
    parser.add_argument("--longest", type=float, default=math.inf, metavar="S", help="only solves within S seconds")
    parser.add_argument("--blocks", type=int, default=2, help="fresh processes, default 2")
    parser.add_argument("--rounds", type=int, default=4, help="interleaved rounds of a block, default 4")


def run_time(options: argparse.Namespace) -> int:
    """Time and print the table; 1 where the machine was too busy."""
    from studies.run.campaign import find
    from studies.run.timing_lane import time_campaign

    blocks, rounds = count("blocks", options.blocks), count("rounds", options.rounds)
    try:
        only = re.compile(options.only)
    except re.error as error:
        raise UsageError(f"--only {options.only!r} must be a regular expression: {error}") from None
    campaign = find(options.campaign, trust=options.trust)
    with progress_bar(campaign.name) as advance:
        table = time_campaign(campaign, options.store, only.search, blocks, rounds, advance, options.longest)
    print(table.to_string(index=False, float_format=lambda x: f"{x:.4g}"))
    if (table["samples"] == 0).any():
        print("footprint: the machine was too busy: the canary moved in every block", file=sys.stderr)
        return FAILED
    return OK


def add_merge(parser: argparse.ArgumentParser) -> None:
    """The foreign store, ours, and how many cells are solved again."""
    parser.add_argument("source", type=Path, metavar="FROM", help="the store of another machine")
    add_store(parser)
    told = "solve so many cells again, drawn by lot, and compare their counters; all: every one"
    parser.add_argument("--again", default="0", metavar="N|all", help=told)


def run_merge(options: argparse.Namespace) -> int:
    """Take what holds; a line on each cell that is refused, and 1 if there is one."""
    from studies.gate.merge import merge

    again = _how_many(options.again)
    with progress_bar("merge") as advance:
        summary = merge(
            options.source, options.store, again, advance, lambda line: print(f"refused: {line}", file=sys.stderr)
        )
    print(f"merge: {summary.line}")
    return FAILED if summary.refused else OK


def _how_many(text: str) -> int:
    from studies.gate.merge import ALL

    if text == ALL:
        return sys.maxsize
    if not (text.isascii() and text.isdigit()):
        raise UsageError(f"--again {text!r} must be a whole number of at least 0, or {ALL}")
    return int(text)


def add_analyse(parser: argparse.ArgumentParser) -> None:
    """The campaign and its store."""
    parser.add_argument("campaign", help=CAMPAIGN)
    add_store(parser)


def run_analyse(options: argparse.Namespace) -> int:
    """Write the tables and print their paths."""
    from studies.analysis.everything import analyse

    with reading(options.store):
        paths = analyse(options.store, options.campaign)
    for path in paths:
        print(path)
    return OK


PAGES = Path("reports/pages")


def add_report(parser: argparse.ArgumentParser) -> None:
    """The store, which campaign of it, and where the pages lie."""
    add_store(parser)
    parser.add_argument("--campaign", metavar="NAME", help="which, where the store has several")
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help=f"where pages lie; default {PAGES}, or the campaign's folder there"
    )
    parser.add_argument("--check", action="store_true", help="compare with the pages in --out instead of writing them")


def run_report(options: argparse.Namespace) -> int:
    """Write the pages and print their paths, or print how they differ."""
    from reports.reading import StoreError
    from reports.site import check_pages, place_of, write_pages
    from studies.run.archive import check_store

    check_store(options.store, options.campaign)
    try:
        folder, line = place_of(options.store, options.campaign)
        out = options.out or PAGES / folder
        print(line)
        if not options.check:
            for path in write_pages(options.store, out, options.campaign):
                print(path)
            return OK
        differences = check_pages(options.store, out, options.campaign)
    except StoreError as error:
        raise UsageError(str(error)) from None
    print("\n".join(differences) or f"{out} agrees with {options.store}")
    return FAILED if differences else OK
