"""``footprint solve``: one scene into a directory."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from studies import branching
from studies.commands import NOT_CONVERGED, OK
from studies.commands.options import add_settings, pairs
from studies.complete import complete
from studies.door.columns import columns
from studies.request import Request, UsageError
from studies.result import UNSTABLE, Result
from studies.scene import Scene
from studies.solving import solve
from studies.step import Step
from studies.store.atomic import write_by
from studies.store.tables import Table

SAME_LINE = "\r\x1b[2K"  # to its beginning, and empty it
COUNTED = ("newton_iterations", "limit_point")  # of the counters of a step, those that a terminal shows


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The request and where its result goes."""
    parser.add_argument("scene")
    parser.add_argument("--measure", default="exact")
    parser.add_argument("--contact", default="semismooth")
    parser.add_argument("--newton", default="mixed", help="plain or mixed")
    parser.add_argument("--mesh", help="N1xN2")
    parser.add_argument("--error", metavar="E", help="refine the grid until a quantity is known that well, e.g. 1%%")
    parser.add_argument("--of", metavar="QUANTITY", help="the quantity of --error; by default the force, or the first")
    parser.add_argument("--model", default="auto", help="auto, full, or what else the scene has")
    parser.add_argument("--steps", type=int, default=1, help="load steps between two requested loads")
    add_settings(parser)
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    parser.add_argument("--plot", action="store_true", help="draw pictures, too")
    parser.add_argument("--branch", action="store_true", help="from an unstable state to the stable branches beside it")
    parser.add_argument("--freeze", type=Path, metavar="FILE", help="write the last contact problem, linearised")


def run(options: argparse.Namespace) -> int:
    """Solve, write and print a short table."""
    given = pairs(options.settings)
    named = {name: getattr(options, name) for name in ("measure", "contact", "newton", "model", "steps")}
    scene, request, wanted = _asked(options, given, **named)
    if options.out.exists() and not options.out.is_dir():
        raise UsageError(f"--out {options.out} is a file, not a directory")
    with _progress() as tell:
        result, enough = _solved(scene, request, wanted, options.of, tell)
    if result.unsupported:
        raise UsageError(result.unsupported)
    asked = options.branch and result.outcome.converged
    if asked:
        branching.branches_of(result)
    result.write(options.out)
    branching.write(result, options.out)
    if options.freeze is not None:
        if result.frozen is None:
            raise UsageError(f"{options.scene} has no contact to freeze")
        write_by(options.freeze, result.frozen().write)
    _print_table(result)
    if asked:
        print("\n".join(branching.lines(result)))
    if options.plot:
        _draw(options.out)
    if not result.outcome.converged:
        print(f"footprint: did not converge: {result.reason}", file=sys.stderr)
        return NOT_CONVERGED
    if wanted is not None and "refinement" in result.tables:
        _print_rounds(result)
    return OK if enough else NOT_CONVERGED


def _draw(out: Path) -> None:
    from reports.figures.result_figures import draw_result
    from reports.store.reading import StoreError

    try:
        draw_result(out)
    except StoreError as error:
        raise UsageError(str(error)) from None


def _asked(options: argparse.Namespace, given: dict[str, str], **named: object) -> tuple[Scene, Request, float | None]:
    """The scene, the request, on the coarsest grid where an error is asked for, and that error."""
    if options.error is None:
        if options.of is not None:
            raise UsageError("--of names the quantity of --error: give both")
        return *complete(options.scene, given, options.mesh, **named), None
    from studies.refinement.error_control import coarsest, parse_error

    wanted = parse_error(options.error)
    return *coarsest(options.scene, given, options.mesh, **named), wanted


def _solved(
    scene: Scene, request: Request, wanted: float | None, quantity: str | None, tell: Callable[[str], None]
) -> tuple[Result, bool]:
    """The result, and whether its error is the one wanted, if any is."""
    if wanted is None:
        return solve(scene, request, tell), True
    from studies.refinement.error_control import solve_to_error

    return solve_to_error(scene, request, wanted, quantity, tell)


@contextmanager
def _progress() -> Iterator[Callable[[str], None]]:
    """Say on the terminal what has been reached; where there is none, nothing, and nothing is loaded for it."""
    if not sys.stderr.isatty():
        yield lambda text: None
        return
    try:
        yield lambda text: print(f"{SAME_LINE}reached {text}", end="", file=sys.stderr, flush=True)
    finally:
        print(SAME_LINE, end="", file=sys.stderr, flush=True)


def _print_table(result: Result) -> None:
    """The loads that were reached, one line each, what fits a terminal."""
    if result.loads:
        _print_columns(Table.of_rows([_row(step) for step in result.loads]))
    if result.request.model_reason:
        print(f"model {result.request.model}: {result.request.model_reason}")
    counters = ", ".join(f"{value} {name.replace('_', ' ')}" for name, value in result.counters.items())
    unstable = ", unstable" if result.verdict == UNSTABLE else ""
    print(f"{result.as_json()['outcome']}{unstable}: {counters}")
    for sentence in (*result.unstable, *result.notes):
        print(sentence)


def _row(step: Step) -> dict[str, object]:
    """What is seen at a load, what it took, and how many eigenvalues are negative, - where they are not counted."""
    row = step.seen | {key: step.counters[key] for key in COUNTED if key in step.counters}
    if "stability" in step.certificate:
        negative = step.certificate["stability"]["negative"]
        row["negative"] = "-" if negative is None else negative
    return row


def _print_rounds(result: Result) -> None:
    """The rounds of refinement, the limit, and what the value on the last grid is off."""
    seen, rounds = result.quantities, result.table("refinement")
    _print_columns(rounds)
    if "uncertainty" not in seen:
        print(result.reason)
        return
    if "loads" in result.tables:
        _print_columns(result.table("loads"))
    name = str(rounds.columns["quantity"][0])
    print(f"{name} = {seen[f'extrapolated_{name}']:.6g} +- {100 * seen['uncertainty']:.2g} %")
    low, high = (100 * seen[key] for key in ("error_low", "error_high"))
    print(f"on the last grid {seen[name]:.6g}, off by {low:.2g} to {high:.2g} %")
    if result.reason:
        print(result.reason)


def _print_columns(table: Table) -> None:
    """Numbers to six digits, flush right."""
    names = list(table.columns)
    shown = ([f"{each:.6g}" if isinstance(each, float) else str(each) for each in row.values()] for row in table.rows())
    print("\n".join(columns([names, *shown], right=range(len(names)))))
