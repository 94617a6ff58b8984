"""``footprint solve``: one scene into a directory."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from contact.problem import Outcome
from studies.ask.request import Request, UsageError
from studies.ask.scene import CutScene, Scene, ShellSceneModel, has_contact
from studies.ask.settings import rubbing
from studies.commands import FAILED, NOT_CONVERGED, OK
from studies.commands.limits import add_limits, bound_of, code_of, limited, look_ahead
from studies.commands.options import (
    add_settings,
    add_solving,
    check_directory,
    check_file,
    named,
    of_file,
    pairs,
    progress_line,
)
from studies.commands.terminal import print_rounds, print_table, references
from studies.output.atomic import write_by
from studies.scenes.complete import complete
from studies.scenes.plugins import blamed
from studies.solving.refinement import mesh_error
from studies.solving.result import WRONG, Result
from studies.solving.solve import Interrupted, word

START_HELP = "start of the path: nested, from its states on coarser grids (default), or cold, from rest"
GRADIENT_HELP = (
    "derivatives of a quantity, e.g. force_N or force_N:p0_MPa,gamma_deg; default with respect to all settings"
)


def add_solve(parser: argparse.ArgumentParser) -> None:
    """The request and where its result goes."""
    measures = "strain measure, see footprint list measures; default exact, or linear for a deck without NLGEOM"
    parser.add_argument("--measure", help=measures)
    mesh = "N1xN2, elements along a1 and a2; by default that of the scene"
    add_solving(parser, "contact algorithm, see footprint list algorithms; default semismooth", mesh)
    parser.add_argument(
        "--error", metavar="E", help="refine the grid until the quantity is known to this relative error, e.g. 1%%"
    )
    parser.add_argument(
        "--of", metavar="QUANTITY", help="with --error: the quantity; default the force, or the first one"
    )
    parser.add_argument("--budget", metavar="SECONDS", help="with --error: the best answer in this wall time, e.g. 5s")
    add_limits(parser)
    add_settings(parser)
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="directory of the result")
    parser.add_argument("--plot", action="store_true", help="draw pictures, too")
    parser.add_argument(
        "--branch", action="store_true", help="from an unstable state, find the stable branches beside it"
    )
    parser.add_argument("--start", choices=mesh_error.STARTS, default=mesh_error.NESTED, metavar="HOW", help=START_HELP)
    parser.add_argument(
        "--no-error", action="store_true", help="do not estimate the error of the mesh from coarser grids"
    )
    parser.add_argument(
        "--no-step-error", action="store_true", help="with friction: do not repeat the path with half steps"
    )
    parser.add_argument("--gradient", metavar="J[:KEYS]", action="append", default=[], help=GRADIENT_HELP)
    parser.add_argument(
        "--check-gradient", action="store_true", help="check the derivatives against solutions at changed settings"
    )
    parser.add_argument("--freeze", type=Path, metavar="FILE", help="write the last linearised contact problem")


def run_solve(options: argparse.Namespace) -> int:
    """Solve, write and print a short table; what overflows on the way to no answer is judged, and not warned of."""
    with np.errstate(over="ignore", invalid="ignore"), of_file(options.scene, options.settings) as deck:
        options.measure = options.measure or (Request.measure if deck is None else deck.measure)
        if deck is not None and options.no_error:
            options.mesh = options.mesh or "1x1"  # its own, where no error is wanted
        return _run(options)


def _run(options: argparse.Namespace) -> int:
    scene, request, error = _asked(options)
    _check_places(options, scene)
    derived = _derived(options, scene, request)
    _check_branches(options, scene, request)
    look_ahead(options, scene, request)
    stop: BaseException | None = None
    beside, refusals = list[str](), list[str]()  # lines; what is refused late costs no result
    with progress_line(bound_of(options)) as tell, limited(options):
        try:
            result, enough = _solved(options, scene, request, error, tell)
        except Interrupted as stopped:
            result, enough, stop = stopped.result, False, stopped.__cause__
        except KeyboardInterrupt as stopped:
            print(
                f"footprint: {word(stopped)} before the requested grid was reached; nothing is written", file=sys.stderr
            )
            return code_of(stopped)
        more = (
            partial(_step_error, options, result, tell),
            partial(_gradients, options, scene, result, derived, tell),
            partial(_check_derived, result, derived),
            partial(_branches, options, result),
        )
        try:
            for ask in () if stop else more:
                try:
                    beside += ask()
                except UsageError as refused:
                    refusals.append(str(refused))
        except KeyboardInterrupt as stopped:
            beside.append(f"{word(stopped)}: load steps, derivatives and branches are incomplete")
            stop = stopped
    if result.unsupported:
        raise UsageError(result.unsupported)
    if isinstance(scene, CutScene) and isinstance(result.model, ShellSceneModel):
        count = len(result.model.shell.discretisation.grid.elements)
        result.remarks.insert(0, f"values of mesh {result.request.mesh_text}, {count} elements")
    files = _written(options, result)
    if options.freeze is not None:
        if result.frozen is None:
            raise UsageError(f"{options.scene} has no contact to freeze")
        write_by(options.freeze, result.frozen().write)
    print_table(result)
    for line in (*mesh_error.lines(result), *references(result), *beside):
        print(line)
    if options.plot:
        result.name(options.out, [*files, *_drawn(options.out)])
    if not result.outcome.converged:
        return _say_why(result, stop)
    if error is not None and "refinement" in result.tables:
        print_rounds(result)
    elif not enough:
        print(result.reason)
    if refusals:
        sys.stdout.flush()  # as of why it ends
        raise UsageError(f"{'; '.join(refusals)}; the result is written")
    if stop is not None:
        return code_of(stop)
    return OK if enough else NOT_CONVERGED


def _written(options: argparse.Namespace, result: Result) -> list[str]:
    """The names of the files of a result, with those of its stable branches."""
    if not result.beside:
        return result.write(options.out)
    from studies.solving import branching  # loaded with branches alone

    return result.write(options.out, branching.write(result, options.out))


def _say_why(result: Result, stop: BaseException | None) -> int:
    """The last line: which condition the judge finds failed, or why the path ends; its exit code."""
    sys.stdout.flush()  # whoever reads both streams as one reads this last
    if result.outcome is Outcome.INTERRUPTED:
        print(f"footprint: {result.reason}; they are written", file=sys.stderr)
        return code_of(stop)
    wrong = result.verdict == WRONG
    print(f"footprint: {'judged wrong' if wrong else 'did not converge'}: {result.reason}", file=sys.stderr)
    return FAILED if wrong else NOT_CONVERGED


def _check_places(options: argparse.Namespace, scene: Scene) -> None:
    """Raise UsageError where nothing could be written, before anything is solved."""
    check_directory(options.out)
    if options.freeze is None:
        return
    if not has_contact(scene):
        raise UsageError(f"{options.scene} has no contact to freeze")
    check_file(options.freeze, "--freeze")
    if not options.freeze.parent.is_dir() and options.freeze.parent.resolve() != options.out.resolve():
        raise UsageError(f"--freeze {options.freeze}: there is no directory {options.freeze.parent}")


def _drawn(out: Path) -> list[str]:
    """Draw, and name the pictures."""
    from reports.figures.result_figures import draw_result
    from reports.files import StoreError

    try:
        return [path.relative_to(out).as_posix() for path in draw_result(out)]
    except StoreError as error:
        raise UsageError(str(error)) from None


def _asked(options: argparse.Namespace) -> tuple[Scene, Request, float | None]:
    """The scene, the request, on the first grid where an error is asked for, and that error."""
    given, how = pairs(options.settings), named(options, "measure", "contact", "newton", "model", "steps")
    if options.error is None:
        if options.of is not None:
            raise UsageError("--of needs --error: it names its quantity")
        if options.budget is not None:
            raise UsageError("--budget needs --error: it limits its time")
        return *complete(options.scene, given, options.mesh, **how), None
    if options.start == mesh_error.COLD:
        raise UsageError("--error starts each grid from the one before: give no --start cold")
    if options.no_error:
        raise UsageError("--error and --no-error exclude each other: give one of them")
    from studies.solving.refinement.error_control import parse_error
    from studies.solving.refinement.grids import first_grid

    error, _ = parse_error(options.error), bound_of(options)  # refused before the first grid, which may be solved for
    return *first_grid(options.scene, given, options.mesh, **how), error


def _solved(
    options: argparse.Namespace, scene: Scene, request: Request, tolerance: float | None, tell: Callable[[str], None]
) -> tuple[Result, bool]:
    """The result, and whether its error is the one wanted, if any is."""
    if tolerance is not None:
        from studies.solving.refinement.cascade import answer, parse_budget

        return answer(scene, request, tolerance, options.of, tell, parse_budget(options.budget))
    asked_for = not options.no_error
    return mesh_error.solve_with_error(scene, request, tell, start=options.start, error=asked_for), True


def _derived(options: argparse.Namespace, scene: Scene, request: Request) -> list[tuple[str, tuple[str, ...]]]:
    """Quantities and settings of --gradient; raises UsageError for a setting without derivative, before any solve."""
    if not options.gradient:
        if options.check_gradient:
            raise UsageError("--check-gradient needs --gradient: it checks its derivatives")
        return []
    from studies.solving.derivatives import gradient  # loaded with derivatives alone

    return [gradient.parse_gradient(text, scene, request) for text in options.gradient]


def _check_branches(options: argparse.Namespace, scene: Scene, request: Request) -> None:
    """Raise UsageError where --branch cannot be answered whatever is solved."""
    if options.branch:
        from studies.solving import branching  # loaded with branches alone

        with blamed(request.contact, request.measure, scene):
            branching.check(request, scene.build(request).stages())


def _step_error(options: argparse.Namespace, result: Result, tell: Callable[[str], None]) -> list[str]:
    """The error of load steps with friction, into the result; what there is to print of it."""
    if options.no_step_error or not rubbing(result.request.settings):
        return []
    from studies.solving import load_steps  # loaded with friction alone

    load_steps.estimate(result, tell)
    return load_steps.lines(result)


def _gradients(
    options: argparse.Namespace,
    scene: Scene,
    result: Result,
    derived: Sequence[tuple[str, tuple[str, ...]]],
    tell: Callable[[str], None],
) -> list[str]:
    """Derivatives into the result, judged where that is asked for; what there is to print of them."""
    if not derived or not result.outcome.converged:
        return []
    from studies.solving.derivatives import gradient  # loaded with derivatives alone

    derived = [each for each in derived if each[0] in gradient.values_of(result)]
    if not derived:
        return []
    gradients = gradient.of_quantities(scene, result, derived, tell)
    gradient.record(result, gradients)
    text_lines = [line for quantity, _ in derived for line in gradient.lines(gradients, quantity)]
    if options.check_gradient:
        from studies.solving.derivatives import taylor

        checked = taylor.check(scene, result, gradients, tell)
        taylor.record(result, checked)
        text_lines += taylor.lines(checked)
    return text_lines


def _check_derived(result: Result, derived: Sequence[tuple[str, tuple[str, ...]]]) -> list[str]:
    """Nothing to print; raises UsageError for quantities of --gradient that the result does not have."""
    if derived and result.outcome.converged:
        from studies.solving.derivatives import gradient  # loaded with derivatives alone

        gradient.check_quantities(result, [quantity for quantity, _ in derived])
    return []


def _branches(options: argparse.Namespace, result: Result) -> list[str]:
    """The stable branches beside the last state, into the result; what there is to print of them."""
    if not options.branch or not result.outcome.converged:
        return []
    from studies.solving import branching  # loaded with branches alone

    branching.branches_of(result)
    return branching.lines(result)
