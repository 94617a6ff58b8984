"""Commands on the cells of a campaign in a store: run, merge, table, time, analyse and report."""

from __future__ import annotations

import argparse
import re
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from studies.ask.request import UsageError
from studies.commands import FAILED, OK
from studies.commands.options import STORE, add_store, add_trust, positive, progress_bar, reading
from studies.output.atomic import write_table

if TYPE_CHECKING:
    from studies.run.task import Limits


CAMPAIGN = "of footprint list campaigns, or a .toml file that was run"


def _name(text: str) -> str:
    """What a store calls the campaign of a file."""
    return Path(text).stem if text.endswith(".toml") else text


def add_run(parser: argparse.ArgumentParser) -> None:
    """The campaign, its store, the engine and the limits of a cell."""
    from studies.fuzz import examine as fuzz
    from studies.fuzz.cases import KINDS
    from studies.run.task import Limits

    parser.add_argument(
        "campaign", help=f"a campaign of footprint list campaigns, a .toml file, or {fuzz.NAME} for random cases"
    )
    add_store(parser)
    add_trust(parser)
    parser.add_argument("--engine", default="serial", help="serial, local:N or dask:ADDRESS; default serial")
    parser.add_argument("--resume", action="store_true", help="only continue a campaign that the store has")
    parser.add_argument("--fields", action="store_true", help="keep the fields of every cell, for footprint merge")
    usual, short = Limits(), fuzz.LIMITS
    help_text = f"wall time of a cell, default {usual.time_s:g}; of a random case {short.time_s:g}"
    parser.add_argument("--time-limit", type=float, metavar="S", help=help_text)
    help_text = f"memory of a cell, default {usual.memory_MB:g}; of a random case {short.memory_MB:g}"
    parser.add_argument("--memory-limit", type=float, metavar="MB", help=help_text)
    seeds = f"with {fuzz.NAME}: cases A to B - 1, default {fuzz.SEEDS}"
    parser.add_argument("--seeds", metavar="A:B", default="", help=seeds)
    parser.add_argument("--kind", choices=list(KINDS), default="", help=f"with {fuzz.NAME}: kind of all cases")


def run_run(options: argparse.Namespace) -> int:
    """Solve the missing cells and print a summary line."""
    from studies.fuzz.examine import NAME as FUZZ
    from studies.run.campaign import find
    from studies.run.running import FAILURES
    from studies.run.running import run as run_campaign
    from studies.run.task import Limits

    if options.campaign == FUZZ:
        return _run_fuzz(options)
    for name in ("seeds", "kind"):
        if getattr(options, name):
            raise UsageError(f"--{name} applies to {FUZZ} only, not to {options.campaign}")
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
    failed = ", ".join(summary.failed)
    store = "" if options.store == STORE else f" --store {shlex.quote(str(options.store))}"
    where = (
        f"; footprint table {campaign.name}{store} names the cells" if any(map(summary.classes.get, FAILURES)) else ""
    )
    print(f"footprint: failed: {failed}{where}", file=sys.stderr)
    return FAILED


def _limits_of(options: argparse.Namespace, usual: Limits) -> Limits:
    """Those that are given, and else the usual ones; raises UsageError."""
    from studies.commands.limits import LARGEST_MB, LARGEST_S
    from studies.run.task import Limits

    time_s = usual.time_s if options.time_limit is None else options.time_limit
    memory_MB = usual.memory_MB if options.memory_limit is None else options.memory_limit
    return Limits(positive("time-limit", time_s, LARGEST_S), positive("memory-limit", memory_MB, LARGEST_MB))


def _run_fuzz(options: argparse.Namespace) -> int:
    """Examine the missing random cases; a broken law is a failed check."""
    from studies.fuzz import examine as fuzz

    if options.fields:
        raise UsageError(f"--fields does not apply to {fuzz.NAME}")
    limits = _limits_of(options, fuzz.LIMITS)
    seeds = _seeds(options.seeds or fuzz.SEEDS)
    with progress_bar(fuzz.NAME) as advance:
        summary = fuzz.run(options.store, seeds, options.kind, options.engine, limits, advance, resume=options.resume)
    print(f"{fuzz.NAME}: {summary.line}")
    print("\n".join(summary.lines))
    for row in summary.rows:
        if row["verdict"] == fuzz.BROKEN:
            print(f"{fuzz.command_of(row['seed'], row['kind'])}: {row['law']}: {row['said']}")
    return FAILED if summary.broken else OK


def _seeds(text: str) -> range:
    """The numbers of the cases."""
    first, _, end = text.partition(":")
    if not (first.isdecimal() and end.isdecimal()):
        raise UsageError(f"--seeds {text!r} must be A:B with two whole numbers")
    return range(int(first), int(end))


def add_table(parser: argparse.ArgumentParser) -> None:
    """The campaign and which of its rows."""
    parser.add_argument("campaign", type=_name, help=CAMPAIGN)
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
        try:
            wanted = float(value) if table[column].dtype.kind in "iuf" else value
        except ValueError:
            raise UsageError(f"--where {pair!r}: this column has numbers") from None
        table = table[table[column] == wanted]
    if options.csv is not None:
        write_table(options.csv, table)
    print(f"{'outcome':15s}{'cell':60s}reason")
    for outcome, label, reason in zip(table["outcome"], table["label"], table["reason"], strict=True):
        print(f"{outcome:15s}{label:59s} {'' if outcome == 'converged' else reason}".rstrip())
    counts = ", ".join(f"{n} {name}" for name, n in table["outcome"].value_counts().items())
    print(f"{len(table)} cells: {counts or 'none'}")
    return OK


def add_time(parser: argparse.ArgumentParser) -> None:
    """The campaign, and which cells."""
    parser.add_argument("campaign", help=CAMPAIGN)
    add_store(parser)
    add_trust(parser)
    parser.add_argument("--only", default="", metavar="REGEX", help="time only cells whose labels match")


def run_time(options: argparse.Namespace) -> int:
    """Time and print the table; 1 where the machine was too busy."""
    from studies.run.campaign import find
    from studies.run.times import time_campaign

    try:
        only = re.compile(options.only)
    except re.error as error:
        raise UsageError(f"--only {options.only!r} must be a regular expression: {error}") from None
    campaign = find(options.campaign, trust=options.trust)
    with progress_bar(campaign.name) as advance:
        table = time_campaign(campaign, options.store, only.search, advance)
    print(table.to_string(index=False, float_format=lambda x: f"{x:.4g}"))
    if (table["samples"] == 0).any():
        print("footprint: the machine was too busy: the canary moved in every block", file=sys.stderr)
        return FAILED
    return OK


def add_merge(parser: argparse.ArgumentParser) -> None:
    """The foreign store, and ours."""
    parser.add_argument("source", type=Path, metavar="FROM", help="the store of another machine")
    add_store(parser)


def run_merge(options: argparse.Namespace) -> int:
    """Take what holds; a line on each cell that is refused, and 1 if there is one."""
    from studies.gate.merge import merge

    with progress_bar("merge") as advance:
        summary = merge(options.source, options.store, advance, lambda line: print(f"refused: {line}", file=sys.stderr))
    print(f"merge: {summary.line}")
    return FAILED if summary.refused else OK


def add_analyse(parser: argparse.ArgumentParser) -> None:
    """The campaign and its store."""
    parser.add_argument("campaign", type=_name, help=CAMPAIGN)
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
    parser.add_argument("--campaign", metavar="NAME", help="campaign, if the store has several")
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help=f"directory of the pages; default {PAGES}, or the folder of the campaign there",
    )
    parser.add_argument("--check", action="store_true", help="compare with the pages in --out instead of writing them")


def run_report(options: argparse.Namespace) -> int:
    """Write the pages and print their paths, or print how they differ."""
    from reports.files import StoreError
    from reports.site import check_pages, left_out, place_of, write_pages
    from studies.run.archive import check_store

    check_store(options.store, options.campaign)
    try:
        folder, line = place_of(options.store, options.campaign)
        out = options.out or PAGES / folder
        print(line, flush=True)
        for note in left_out(options.store, options.campaign):
            print(f"footprint: {note}", file=sys.stderr)
        if not options.check:
            for path in write_pages(options.store, out, options.campaign):
                print(path)
            return OK
        differences = check_pages(options.store, out, options.campaign)
    except StoreError as error:
        raise UsageError(str(error)) from None
    print("\n".join(differences) or f"{out} agrees with {options.store}")
    return FAILED if differences else OK
