"""``footprint sweep``: a scene over one or two settings, each member judged and kept as soon as it is solved.

``footprint extremes`` and ``footprint fuzz`` solve and judge one case again: a point of a map, a random one.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from studies.ask.request import Request, UsageError
from studies.commands import FAILED, NOT_CONVERGED, OK, WRONG_USE
from studies.commands.options import add_settings, add_solving, check_directory, named, of_file, pairs, progress_bar
from studies.solving.refinement.error_control import parse_error
from studies.solving.result import CONVERGED, UNSTABLE, WRONG
from studies.sweeps.members import LONGEST, MOST, Member
from studies.sweeps.sweep import MEMBERS, Sweep, sweep

OVER = f"N values from A to B, N in [2, {LONGEST}]; for one setting or two, at most {MOST} members"
SHOWN = 5  # members without an answer that are named, and different notes


def add_sweep(parser: argparse.ArgumentParser) -> None:
    """The request, the ranges, the error, and where the answer goes."""
    parser.add_argument("--over", action="append", default=[], metavar="KEY=A:B:N", help=OVER)
    measures = "strain measure, see footprint list measures; default exact, or linear for a deck without NLGEOM"
    parser.add_argument("--measure", help=measures)
    mesh = "N1xN2, elements along a1 and a2, for all members; default that of the scene"
    add_solving(parser, "contact algorithm, see footprint list algorithms; default semismooth", mesh)
    parser.add_argument(
        "--error", metavar="E", help="say whether each member is known to this relative error, e.g. 1%%"
    )
    parser.add_argument("--of", metavar="QUANTITY", help="quantity; default the force, or the first one of the scene")
    add_settings(parser)
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="directory of the result; members in it are reused"
    )


def run_sweep(options: argparse.Namespace) -> int:
    """Solve what is missing, write and print; 1 where the judge refuses a member, 3 where others have no answer, or not
    to the error. Members that were finished before an interruption are kept.
    """
    check_directory(options.out)
    error = None if options.error is None else parse_error(options.error)
    over = ranges(options.over)
    with (
        of_file(options.scene, options.settings) as deck,
        np.errstate(over="ignore", invalid="ignore"),
        progress_bar("sweep") as tell,
    ):
        options.measure = options.measure or (Request.measure if deck is None else deck.measure)
        how = named(options, "measure", "contact", "newton", "model", "steps")
        given = pairs(options.settings)
        kept = options.out / MEMBERS
        result = sweep(options.scene, given, over, error, options.of, kept, tell, options.mesh, **how)
    from reports.figures.comparisons import draw_sweep

    result.write(options.out, draw_sweep(options.out, *result.picture))
    print("\n".join(lines(result)))
    sys.stdout.flush()
    if any(member.verdict == WRONG for member in result.failed):
        return FAILED
    return OK if (not result.failed and error is None) or result.within == len(result.members) else NOT_CONVERGED


def ranges(words: Sequence[str]) -> dict[str, str]:
    """Texts A:B:N by setting, of ``--over``; raises UsageError."""
    texts: dict[str, str] = {}
    for word in words:
        key, separator, text = word.partition("=")
        if not separator or key in texts:
            raise UsageError(f"--over {word!r} must be KEY=A:B:N, each setting once")
        texts[key] = text
    return texts


def lines(result: Sweep) -> Iterator[str]:
    """The answer for a terminal."""
    over = ", ".join(f"{each.key} {each.values[0]:g} to {each.values[-1]:g}" for each in result.ranges)
    counts = " x ".join(str(len(each.values)) for each in result.ranges)
    yield f"{result.name}, {counts} members on {result.middle.mesh_text}: {over}"
    members, name, lost = list(result.members.values()), result.quantity, result.failed
    valued = [(value, member) for member in members if (value := member.quantities.get(name)) is not None]
    if valued:
        ends = (end(valued, key=lambda each: each[0]) for end in (min, max))
        yield f"{name} from " + " to ".join(f"{value:.6g} at {_at(member)}" for value, member in ends)
    unstable = sum(member.verdict == UNSTABLE for member in members)
    yield f"{len(members) - len(lost)} solved, {unstable} of them unstable, {len(lost)} without an answer"
    if result.error is not None:
        errors = [error for member in members if (error := member.error(name)) is not None]
        most = f", the largest known is {100 * max(errors):.2g} %" if errors else ", none is known"
        yield f"error of {name} within {100 * result.error:g} %: {result.within} of {len(members)}{most}"
    else:
        yield "the error of the mesh is not known: --error E asks for it"
    cold = result.cold
    price = (
        f"; one member from rest {cold:.3g} s, {len(members) * cold / result.seconds:.2g} members for that price"
        if cold
        else ""
    )
    yield f"{result.seconds:.3g} CPU s{price}"
    noted = Counter(member.reason for member in members if member.verdict == CONVERGED and member.reason)
    yield from (f"{count} of {len(members)} members: {note}" for note, count in noted.most_common(SHOWN))
    if len(noted) > SHOWN:
        yield f"and {len(noted) - SHOWN} other notes, in the column reason of sweep.csv"
    yield from (f"{each.verdict} at {_at(each)}: {each.reason}" for each in lost[:SHOWN])
    if len(lost) > SHOWN:
        yield f"and {len(lost) - SHOWN} more without an answer"


def _at(member: Member) -> str:
    return ", ".join(f"{key} {value:g}" for key, value in member.settings.items())


def add_extremes(parser: argparse.ArgumentParser) -> None:
    """The map and the point."""
    parser.add_argument("map", nargs="?", help="name of a map; without it the maps are listed")
    parser.add_argument("--at", metavar="X,Y", help="values on both axes")


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
    parser.add_argument("--kind", choices=list(KINDS), default="", help="kind of the case, by default drawn from N")
    parser.add_argument("--smaller", action="store_true", help="simplify the case as long as it breaks the same law")


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
