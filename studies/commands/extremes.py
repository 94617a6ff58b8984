"""``footprint extremes``: one point of a map of extremes, solved and judged."""

from __future__ import annotations

import argparse

from studies.ask.scene import UsageError
from studies.commands import FAILED, NOT_CONVERGED, OK, WRONG_USE
from studies.experiments.extremes import CHARTS, CONVERGED, REFUSED, UNSTABLE, UNTOUCHED, WRONG, attempt, chart_of


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The map and the point."""
    parser.add_argument("map", nargs="?", help="left out: the maps there are")
    parser.add_argument("--at", metavar="X,Y", help="values along both axes")


def run(options: argparse.Namespace) -> int:
    """Print the maps, or what became of the point."""
    if options.map is None:
        print("\n".join(f"{chart.name:18s}{chart.title}" for chart in CHARTS))
        return OK
    chart = chart_of(options.map)
    x, _, y = (options.at or "").partition(",")
    if not x or not y:
        raise UsageError(f"--at {options.at!r} must be X,Y: {chart.x.label}, {chart.y.label}")
    cell = chart.point(x, y)
    found = attempt(cell)
    print(f"{found.kind}: {found.reason or cell.command}")
    print(f"{found.iterations} newton iterations, {found.factorisations} factorisations")
    if found.kind in (CONVERGED, UNTOUCHED, UNSTABLE):
        return OK
    return {WRONG: FAILED, REFUSED: WRONG_USE}.get(found.kind, NOT_CONVERGED)
