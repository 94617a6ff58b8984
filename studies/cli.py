"""The command line: ``footprint list | solve | resolve | run | table | time | analyse``, and more of them:
``report | advise | check | compare | bench``.

Exit codes: 0 fine, 1 a check failed, 2 wrong use (one line), 3 did not converge (result.json is still written).
Heavy imports wait until a command needs them.
"""

from __future__ import annotations

import argparse
import gc
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

if TYPE_CHECKING:
    from studies.scene import Request, Scene
    from studies.solve import Result

OK, FAILED, WRONG_USE, NOT_CONVERGED = 0, 1, 2, 3
PAGES = Path("reports/pages")


class _Parser(argparse.ArgumentParser):
    """argparse, but an error is one line."""

    def error(self, message: str) -> NoReturn:
        print(f"{self.prog}: {message}", file=sys.stderr)
        raise SystemExit(WRONG_USE)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    options = _parser().parse_args(arguments)
    # before numpy is loaded: threads of small matrices only wait for one another, 5 times as long on a busy machine
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from studies.scene import UsageError

    try:
        return int(options.command(options))
    except (UsageError, OSError) as error:
        print(f"footprint: {error}", file=sys.stderr)
        return WRONG_USE
    except KeyboardInterrupt:
        print("footprint: interrupted; what was finished is kept", file=sys.stderr)
        return 130
    finally:
        if arguments is None:  # the process ends here: without this it takes a tenth of a small solve to tidy up first
            gc.freeze()


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="footprint", description="Compare shell strain measures and contact algorithms.")
    commands = parser.add_subparsers(required=True, parser_class=_Parser, metavar="COMMAND")

    command = commands.add_parser("list", help="what there is")
    command.add_argument("what", nargs="?", choices=("scenes", "measures", "algorithms", "campaigns"))
    command.set_defaults(command=_list)

    command = commands.add_parser("solve", help="solve one scene into a directory")
    command.add_argument("scene")
    command.add_argument("--measure", default="exact")
    command.add_argument("--contact", default="semismooth")
    command.add_argument("--newton", default="mixed", help="plain or mixed")
    command.add_argument("--mesh", help="N1xN2")
    command.add_argument("--error", metavar="E", help="choose the mesh for an error of the force, e.g. 1%%")
    command.add_argument("--model", default="auto", help="auto, full, or what else the scene has")
    command.add_argument("--steps", type=int, default=1, help="load steps between two requested loads")
    command.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="settings")
    command.add_argument("--out", type=Path, required=True, metavar="DIR")
    command.add_argument("--plot", action="store_true", help="draw pictures, too")
    command.add_argument("--freeze", type=Path, metavar="FILE", help="write the last contact problem, linearised")
    command.set_defaults(command=_solve)

    command = commands.add_parser("resolve", help="solve one frozen contact problem again, alone, and judge it")
    command.add_argument("file", type=Path, metavar="FILE")
    command.add_argument("--contact", default="semismooth")
    command.add_argument("--epsilon", type=float, help="regularisation, MPa/mm; default that of the algorithm")
    command.add_argument("--oracle", action="store_true", help="compare with a quadratic programme by cvxpy")
    command.set_defaults(command=_resolve)

    command = commands.add_parser("run", help="solve the missing cells of a campaign")
    command.add_argument("campaign", help="a name of its own, or a .toml file")
    command.add_argument("--store", type=Path, required=True, metavar="DIR")
    command.add_argument("--engine", default="serial", help="serial, local:N or dask:ADDRESS; default serial")
    command.add_argument("--resume", action="store_true", help="only go on with a campaign that the store knows")
    command.add_argument("--time-limit", type=float, default=900.0, metavar="S", help="of one cell, default 900")
    command.add_argument("--memory-limit", type=float, default=8192.0, metavar="MB", help="of one cell, default 8192")
    command.set_defaults(command=_run)

    command = commands.add_parser("table", help="the cells of a campaign, what was asked and what became of them")
    command.add_argument("campaign")
    command.add_argument("--store", type=Path, required=True, metavar="DIR")
    command.add_argument("--where", action="append", default=[], metavar="COLUMN=VALUE", help="only these rows")
    command.add_argument("--csv", type=Path, metavar="FILE", help="write all columns as CSV")
    command.set_defaults(command=_table)

    command = commands.add_parser("time", help="time the converged cells of a campaign, one at a time")
    command.add_argument("campaign")
    command.add_argument("--store", type=Path, required=True, metavar="DIR")
    command.add_argument("--only", default="", metavar="REGEX", help="the labels that are timed")
    command.add_argument("--blocks", type=int, default=2, help="fresh processes, default 2")
    command.add_argument("--rounds", type=int, default=4, help="interleaved rounds of a block, default 4")
    command.set_defaults(command=_time)

    command = commands.add_parser(
        "analyse", help="the tables of fronts, profiles, attribution and advice of a campaign"
    )
    command.add_argument("campaign")
    command.add_argument("--store", type=Path, required=True, metavar="DIR")
    command.set_defaults(command=_analyse)

    command = commands.add_parser("report", help="write the pages of a store")
    command.add_argument("--store", type=Path, required=True, metavar="DIR")
    command.add_argument("--campaign", metavar="NAME", help="which, where the store has several")
    command.add_argument("--out", type=Path, metavar="DIR", help=f"default {PAGES}, or the campaign's folder there")
    command.add_argument("--check", action="store_true", help="compare with the pages in --out instead of writing them")
    command.set_defaults(command=_report)

    command = commands.add_parser("advise", help="the cheapest configuration of a scene that meets a tolerance")
    command.add_argument("scene")
    command.add_argument("--error", required=True, metavar="E", help="relative, e.g. 1%%")
    command.add_argument("--quantity", metavar="NAME", help="e.g. force_N; default: the first one of the scene")
    command.add_argument("--store", type=Path, required=True, metavar="DIR")
    command.add_argument("--campaign", default="standard", help="default standard")
    command.add_argument("--cost", default="flops", help="dofs, factorisations, flops or seconds; default flops")
    command.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="settings")
    command.set_defaults(command=_advise)

    command = commands.add_parser("check", help="compare a fresh campaign with the committed baseline")
    command.add_argument("--store", type=Path, metavar="DIR", help="one that has the campaign; default: solve it now")
    command.add_argument("--campaign", default="quick", help="default quick")
    command.add_argument("--engine", default="serial", help="as of run, where it is solved now")
    command.add_argument("--baseline", type=Path, metavar="FILE", help="default: the committed one")
    command.add_argument("--update", action="store_true", help="replace the baseline; with --owner and --reason")
    command.add_argument("--owner", default="", metavar="NAME", help="who answers for an update")
    command.add_argument("--reason", default="", metavar="TEXT", help="why the baseline is replaced")
    command.add_argument("--date", metavar="YYYY-MM-DD", help="of an update, default today")
    command.add_argument(
        "--time", nargs=2, type=Path, metavar=("BEFORE", "NOW"), help="two stores with times of the timing lane"
    )
    command.set_defaults(command=_check)

    command = commands.add_parser("compare", help="two stores side by side, as a comment for a review")
    command.add_argument("before", type=Path, metavar="A")
    command.add_argument("now", type=Path, metavar="B")
    command.add_argument("--campaign", default="quick", help="default quick")
    command.set_defaults(command=_compare)

    command = commands.add_parser("extremes", help="solve and judge one point of a map of extremes")
    command.add_argument("map", nargs="?", help="left out: the maps there are")
    command.add_argument("--at", metavar="X,Y", help="values along both axes")
    command.set_defaults(command=_extremes)

    command = commands.add_parser("bench", help="cost of one Newton iteration, as ratios")
    command.add_argument("--mesh", help="N1xN2, default 42x40; with --scaling, --peers several, comma-separated")
    command.add_argument("--repeats", type=int, help="default 9")
    command.add_argument("--scaling", action="store_true", help="one Newton step from 2,000 to 250,000 unknowns")
    command.add_argument(
        "--peers", action="store_true", help="NGSolve's solids beside shells, --mesh 8x8,14x12 of a quarter"
    )
    command.add_argument("--harness", action="store_true", help="what running and reading cells costs beside solving")
    command.add_argument("--machine", choices=("floors",), help="with --scaling: times over the machine's own, too")
    command.add_argument("--table", type=Path, metavar="FILE", help="with --scaling, --peers: write the table as CSV")
    command.set_defaults(command=_bench)
    return parser


def _list(options: argparse.Namespace) -> int:
    from contact.catalogue import ALGORITHMS
    from formulations.strains.catalogue import MEASURES
    from studies.campaigns.file import find, names
    from studies.scenes import SCENES

    lists = {
        "scenes": [f"{name:18s}{scene.title}" for name, scene in SCENES.items()],
        "measures": list(MEASURES),
        "algorithms": list(ALGORITHMS),
        "campaigns": [f"{name:18s}{find(name).title}" for name in names()],
    }
    for what in [options.what] if options.what else lists:
        if not options.what:
            print(f"{what}:")
        print("\n".join(("" if options.what else "  ") + line for line in lists[what]))
    return OK


def _solve(options: argparse.Namespace) -> int:
    from studies.scene import UsageError
    from studies.solve import resolve
    from studies.store.atomic import write_by

    given = _pairs(options.settings)
    wanted = _wanted_error(options, given)
    scene, request = resolve(
        options.scene,
        given,
        options.mesh,
        **{name: getattr(options, name) for name in ("measure", "contact", "newton", "model", "steps")},
    )
    if options.out.exists() and not options.out.is_dir():
        raise UsageError(f"--out {options.out} is a file, not a directory")
    with _told() as tell:
        result, enough = _solved(scene, request, wanted, tell)
    if result.unsupported:
        raise UsageError(result.unsupported)
    result.write(options.out)
    if options.freeze is not None:
        if result.frozen is None:
            raise UsageError(f"{options.scene} has no contact to freeze")
        write_by(options.freeze, result.frozen().write)
    _print_table(result.as_json())
    if options.plot:
        from reports.result_figures import draw_result
        from reports.tables import StoreError

        try:
            draw_result(options.out)
        except StoreError as error:
            raise UsageError(str(error)) from None
    if not result.outcome.converged:
        print(f"footprint: did not converge: {result.reason}", file=sys.stderr)
        return NOT_CONVERGED
    if wanted is not None:
        _print_ladder(result, enough)
    return OK if enough else NOT_CONVERGED


def _pairs(settings: Sequence[str]) -> dict[str, str]:
    """The settings of ``--set KEY=VALUE``."""
    from studies.scene import UsageError

    given: dict[str, str] = {}
    for pair in settings:
        key, separator, value = pair.partition("=")
        if not separator:
            raise UsageError(f"--set {pair!r} must be KEY=VALUE")
        given[key] = value
    return given


def _wanted_error(options: argparse.Namespace, given: dict[str, str]) -> float | None:
    """The error that is asked for; the grid is then an adapted one. Raises UsageError beside a mesh or a grading."""
    if options.error is None:
        return None
    from studies.error_control import parse_error
    from studies.scene import UsageError
    from studies.scenes import SCENES

    if not hasattr(SCENES.get(options.scene), "adapted"):
        raise UsageError(f"scene {options.scene!r} has no --error; choose its mesh")
    if options.mesh is not None or given.get("grading", "adapted") != "adapted":
        raise UsageError("--error chooses an adapted mesh: leave out --mesh and grading")
    given["grading"] = "adapted"
    return parse_error(options.error)


def _solved(scene: Scene, request: Request, wanted: float | None, tell: Callable[[str], None]) -> tuple[Result, bool]:
    """The result, and whether its error is the one wanted, if any is."""
    if wanted is None:
        from studies.solve import solve

        return solve(scene, request, tell), True
    from studies.error_control import AdaptiveScene, solve_to_error

    assert isinstance(scene, AdaptiveScene)
    return solve_to_error(scene, request, wanted, tell)


def _print_ladder(result: Result, enough: bool) -> None:
    """The rungs, and the mesh that was chosen, or none."""
    print(result.tables["ladder"][0].to_string(index=False, float_format=lambda x: f"{x:.6g}"))
    seen = result.quantities
    if "error_high" in seen:
        low, at, high = (100 * seen[key] for key in ("error_low", "error_estimate", "error_high"))
        print(f"force {seen['force_N']:.6g} N, error {at:.2g} % in [{low:.2g}, {high:.2g}] %")
    n1, n2 = result.request.mesh
    print(f"mesh for {100 * seen['error_asked']:g} %: " + (f"{n1}x{n2}" if enough else f"none; {result.reason}"))


@contextmanager
def _told() -> Iterator[Callable[[str], None]]:
    """Say on the terminal what has been reached; where there is none, nothing, and nothing is loaded for it."""
    if not sys.stderr.isatty():
        yield lambda text: None
        return
    from rich.console import Console

    with Console(stderr=True).status("building") as status:
        yield lambda text: status.update(f"reached {text}")


def _resolve(options: argparse.Namespace) -> int:
    from studies.replay import resolve_step
    from studies.scene import UsageError

    if options.epsilon is not None and not options.epsilon > 0:
        raise UsageError(f"epsilon = {options.epsilon} must be a number in (0, inf]")
    found = resolve_step(options.file, options.contact, options.epsilon, oracle=options.oracle)
    print("\n".join(found.lines()))
    if not found.solution.outcome.converged:
        return NOT_CONVERGED
    return OK if found.sound else FAILED


def _print_table(result: dict[str, object]) -> None:
    """The entries of ``steps``, one line each, what fits a terminal."""
    import pandas as pd

    steps = result["steps"]
    assert isinstance(steps, list)
    if steps:
        left_out = {
            "kkt",
            "balances",
            "failures",
            "diagnosis",
            "rounding",
            "factorisations",
            "assemblies",
            "flops",
            "set_changes",
            "substeps",
        }
        scalars = [{key: value for key, value in step.items() if key not in left_out} for step in steps]
        print(pd.DataFrame(scalars).to_string(index=False, float_format=lambda x: f"{x:.6g}"))
    if result["model_reason"]:
        print(f"model {result['model']}: {result['model_reason']}")
    counters = result["counters"]
    assert isinstance(counters, dict)
    print(f"{result['outcome']}: " + ", ".join(f"{value} {name.replace('_', ' ')}" for name, value in counters.items()))


def _run(options: argparse.Namespace) -> int:
    from rich.progress import Progress

    from studies.campaigns.file import find
    from studies.campaigns.run import run
    from studies.pool.process import Limits

    limits = Limits(_positive("time-limit", options.time_limit), _positive("memory-limit", options.memory_limit))
    campaign = find(options.campaign)
    with Progress() as bar:
        task = bar.add_task(campaign.name)
        summary = run(
            campaign,
            options.store,
            options.engine,
            limits,
            lambda done, planned, label: bar.update(task, completed=done, total=planned, description=label),
            lambda line: print(f"footprint: {line}", file=sys.stderr),
            resume=options.resume,
        )
    print(f"{campaign.name}: {summary.line}")
    return OK


def _table(options: argparse.Namespace) -> int:
    from studies.analysis.collect import collect
    from studies.scene import UsageError
    from studies.store.atomic import write_table

    table = collect(options.store, options.campaign)
    for pair in options.where:
        column, separator, value = pair.partition("=")
        if not separator or column not in table:
            raise UsageError(f"--where {pair!r} must be COLUMN=VALUE with one of {', '.join(map(str, table.columns))}")
        numbers = table[column].dtype.kind == "f"
        table = table[table[column] == (_number(pair, value) if numbers else value)]
    if options.csv is not None:
        write_table(options.csv, table)
    print(f"{'outcome':15s}{'cell':60s}reason")
    for outcome, label, reason in zip(table["outcome"], table["label"], table["reason"], strict=True):
        print(f"{outcome:15s}{label:60s}{'' if outcome == 'converged' else reason}".rstrip())
    print(f"{len(table)} cells: " + ", ".join(f"{n} {name}" for name, n in table["outcome"].value_counts().items()))
    return OK


def _number(pair: str, value: str) -> float:
    from studies.scene import UsageError

    try:
        return float(value)
    except ValueError:
        raise UsageError(f"--where {pair!r}: this column has numbers") from None


def _time(options: argparse.Namespace) -> int:
    import re

    from rich.progress import Progress

    from studies.bench.timing_lane import time_campaign
    from studies.campaigns.file import find
    from studies.scene import UsageError

    for name in ("blocks", "rounds"):
        if not 1 <= getattr(options, name) <= 1000:
            raise UsageError(f"{name} = {getattr(options, name)} must be a whole number in [1, 1000]")
    try:
        only = re.compile(options.only)
    except re.error as error:
        raise UsageError(f"--only {options.only!r} must be a regular expression: {error}") from None
    campaign = find(options.campaign)
    with Progress() as bar:
        task = bar.add_task(campaign.name)
        table = time_campaign(
            campaign,
            options.store,
            only.search,
            options.blocks,
            options.rounds,
            lambda done, planned, label: bar.update(task, completed=done, total=planned, description=label),
        )
    print(table.to_string(index=False, float_format=lambda x: f"{x:.4g}"))
    if (table["samples"] == 0).any():
        print("footprint: the machine was too busy: the canary moved in every block", file=sys.stderr)
        return FAILED
    return OK


def _positive(name: str, value: float) -> float:
    from studies.scene import UsageError

    if not 0 < value < float("inf"):
        raise UsageError(f"{name} = {value} must be a number in (0, inf)")
    return value


def _report(options: argparse.Namespace) -> int:
    from reports.site import check_pages, place_of, write_pages
    from reports.tables import StoreError
    from studies.scene import UsageError

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


def _analyse(options: argparse.Namespace) -> int:
    from studies.analysis.everything import analyse

    for path in analyse(options.store, options.campaign):
        print(path)
    return OK


def _advise(options: argparse.Namespace) -> int:
    from studies.analysis.advise import advise, asked_question, lines
    from studies.analysis.collect import collect
    from studies.analysis.verify import verified
    from studies.error_control import parse_error

    tolerance, given = parse_error(options.error), _pairs(options.settings)
    table = collect(options.store, options.campaign)
    question = asked_question(table, verified(table), options.scene, options.quantity, given, options.cost)
    found = advise(question, tolerance, options.cost)
    print("\n".join(lines(found, options.cost)))
    return OK if found.best is not None else FAILED


def _check(options: argparse.Namespace) -> int:
    from studies.guard import check as gate
    from studies.guard.compare import NothingComparedError
    from studies.scene import UsageError

    if options.time is not None and (options.update or options.store is not None or options.baseline is not None):
        raise UsageError("--time compares two stores and no baseline")
    if not options.update and (options.owner or options.reason or options.date):
        raise UsageError("--owner, --reason and --date go with --update")
    try:
        if options.time is not None:
            worse = gate.check_times(options.time[0], options.time[1], options.campaign)
        elif options.update:
            gate.update_baseline(options)
            return OK
        else:
            worse = gate.check_baseline(options.campaign, options.store, options.baseline, options.engine)
    except NothingComparedError as error:
        print(f"footprint: check failed: {error}", file=sys.stderr)
        return FAILED
    return FAILED if worse else OK


def _compare(options: argparse.Namespace) -> int:
    from studies.guard.check import compare_stores
    from studies.guard.compare import NothingComparedError

    try:
        print(compare_stores(options.before, options.now, options.campaign), end="")
    except NothingComparedError as error:
        print(f"footprint: {error}", file=sys.stderr)
        return FAILED
    return OK


def _extremes(options: argparse.Namespace) -> int:
    from studies.experiments.extremes.maps import CHARTS, CONVERGED, REFUSED, UNTOUCHED, WRONG, attempt, chart_of
    from studies.scene import UsageError

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
    if found.kind in (CONVERGED, UNTOUCHED):
        return OK
    return {WRONG: FAILED, REFUSED: WRONG_USE}.get(found.kind, NOT_CONVERGED)


def _bench(options: argparse.Namespace) -> int:
    from studies.scene import UsageError

    if options.scaling + options.peers + options.harness > 1:
        raise UsageError("--scaling, --peers and --harness are tables of their own: one at a time")
    if options.harness:
        return _harness(options)
    if options.scaling:
        if options.repeats is not None:
            raise UsageError("--repeats does not go with --scaling, which repeats for a time")
        return _scaling(options)
    if options.peers:
        if options.repeats is not None:
            raise UsageError("--repeats does not go with --peers, whose solids take long")
        if options.machine:
            raise UsageError("--machine goes with --scaling only")
        return _peers(options)
    if options.machine or options.table:
        raise UsageError("--machine goes with --scaling only, --table with --scaling or --peers")
    mesh, repeats = options.mesh or "42x40", 9 if options.repeats is None else options.repeats
    if not 1 <= repeats <= 1000:
        raise UsageError(f"repeats = {repeats} must be a whole number in [1, 1000]")
    from studies.bench.newton import bench

    cost = bench(mesh, repeats=repeats)
    print(f"one Newton iteration, tyre {mesh}, {cost.dofs} dofs, medians of {repeats}")
    print(f"{'part':16s}{'ms':>10s}{'/ factorisation':>18s}")
    for part in ("elements", "scatter", "prediction", "contact", "factorisation", "solution", "total"):
        seconds = getattr(cost, part)
        print(f"{part:16s}{1e3 * seconds:10.2f}{seconds / cost.factorisation:18.3f}")
    return OK


def _harness(options: argparse.Namespace) -> int:
    from studies.bench.overhead import harness, lines
    from studies.scene import UsageError

    if options.machine or options.table or options.mesh:
        raise UsageError("--harness goes with --repeats only")
    costs = harness(9 if options.repeats is None else options.repeats)
    print("\n".join(lines(costs)))
    return OK if all(cost.kept for cost in costs) else FAILED


def _scaling(options: argparse.Namespace) -> int:
    from rich.console import Console
    from rich.progress import Progress

    from studies.bench.scaling import MESHES, lines, request_of, scaling
    from studies.store.atomic import write_table

    meshes = options.mesh.split(",") if options.mesh else MESHES
    for mesh in meshes:
        request_of(mesh)  # what is wrong is said before the bar is drawn
    with Progress(console=Console(stderr=True)) as bar:
        task = bar.add_task("scaling")
        table = scaling(
            meshes,
            lambda done, planned, label: bar.update(task, completed=done, total=planned, description=label),
        )
    if options.table is not None:
        write_table(options.table, table)
    print("one Newton step in contact, tyre, element paper, model full, shortest processor times in ms")
    print("\n".join(lines(table, floors=options.machine == "floors")))
    return OK


def _peers(options: argparse.Namespace) -> int:
    from studies.bench.peers import DELTA_MM, PEER_MESHES, lines, peers
    from studies.store.atomic import write_table

    table = peers(options.mesh.split(",") if options.mesh else PEER_MESHES)
    if options.table is not None:
        write_table(options.table, table)
    print(
        f"isotropic tyre, {DELTA_MM:g} mm, a quarter; meshes of footprint count the whole, those of ngsolve the quarter"
    )
    print("\n".join(lines(table)))
    return NOT_CONVERGED if table["force_N"].isna().any() else OK


if __name__ == "__main__":
    sys.exit(main())
