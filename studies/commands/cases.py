"""One case solved again and judged: ``footprint extremes``, a point of a map, and ``footprint fuzz``, a random one."""

from __future__ import annotations

import argparse

from studies.ask.request import UsageError
from studies.commands import FAILED, NOT_CONVERGED, OK, WRONG_USE


def add_extremes(parser: argparse.ArgumentParser) -> None:
    """The map and the point."""
    parser.add_argument("map", nargs="?", help="left out: the maps there are")
    parser.add_argument("--at", metavar="X,Y", help="values along both axes")


def run_extremes(options: argparse.Namespace) -> int:
    """Print the list of maps, or the outcome at one point."""
    from studies.experiments import extremes

    if options.map is None:
        print("\n".join(f"{chart.name:18s}{chart.title}" for chart in extremes.CHARTS))
        return OK
    chart = extremes.chart_of(options.map)
    x, _, y = (options.at or "").partition(",")
    if not x or not y:
        raise UsageError(f"--at {options.at!r} must be X,Y: {chart.x.label}, {chart.y.label}")
    cell = chart.point(x, y)
    result = extremes.attempt(cell)
    print(f"{result.kind}: {result.reason or cell.command}")
    if result.kind in (extremes.CONVERGED, extremes.UNTOUCHED, extremes.UNSTABLE):
        return OK
    return {extremes.WRONG: FAILED, extremes.REFUSED: WRONG_USE}.get(result.kind, NOT_CONVERGED)


def add_fuzz(parser: argparse.ArgumentParser) -> None:
    """The number of the case."""
    from studies.fuzz.cases import KINDS

    parser.add_argument("--seed", type=int, required=True, metavar="N", help="number of the case, from 0")
    parser.add_argument("--kind", choices=list(KINDS), default="", help="of the case, by default drawn from N")
    parser.add_argument("--smaller", action="store_true", help="give settings back while the same law is broken")


def run_fuzz(options: argparse.Namespace) -> int:
    """Print what was asked, what came of it, and which law it breaks."""
    from studies.fuzz.examine import BROKEN, examine

    if options.seed < 0:
        raise UsageError(f"seed = {options.seed} must be a whole number, 0 or more")
    report = examine(options.seed, options.kind, smaller=options.smaller)
    print(f"{report.kind}: {report.about}")
    for name, text in (("came to", report.word), ("law", report.law), (report.verdict, report.said)):
        if text:
            print(f"{name}: {text}")
    return FAILED if report.verdict == BROKEN else OK
