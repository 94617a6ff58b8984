"""``footprint problems``: the collection of frozen contact problems, for other programs and their answers.

``footprint resolve``: one of them again, alone, judged.

``footprint tasks``: runs that go wrong, and a submission of what to choose instead, graded claim by claim.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from itertools import count
from pathlib import Path

import pandas as pd

from contact.interchange.linearised_step import FrozenStep
from studies.arena import held_out
from studies.arena.tasks.catalogue import HIDDEN, tasks
from studies.arena.tasks.grading import LIMIT_S, Grade, grade, read_submission
from studies.ask.request import UsageError
from studies.commands import FAILED, INTERRUPTED, NOT_CONVERGED, OK
from studies.commands.options import check_directory, check_file, positive, progress_bar
from studies.output.atomic import write_json
from studies.output.provenance import provenance
from studies.output.terminal import columns

PROBLEMS = Path(".footprint/problems")
RUBBED = ("name", "unknowns", "candidates", "open", "sticking", "slipping", "mu", "kind", "friction")
SHOWN = ("name", "unknowns", "candidates", "pressed", "touching", "kind", "coupling", "split", "adds")


def add_problems(parser: argparse.ArgumentParser) -> None:
    """One subcommand each."""
    parts = parser.add_subparsers(
        required=True, metavar="list|make|check|export|import|judge", parser_class=type(parser)
    )

    listing = parts.add_parser("list", help="list the problems with their traits and what each adds")
    listing.set_defaults(part=_list)

    making = parts.add_parser("make", help="make the missing files")
    making.add_argument("--out", type=Path, default=PROBLEMS, metavar="DIR", help="directory of the files")
    making.add_argument(
        "--choose", action="store_true", help="select the problems anew by the rule: a new manifest, about an hour"
    )
    making.set_defaults(part=_make)

    checking = parts.add_parser("check", help="check files against the manifest of the suite")
    checking.add_argument(
        "directory",
        type=Path,
        nargs="?",
        default=PROBLEMS,
        metavar="DIR",
        help=f"directory of the files, default {PROBLEMS}",
    )
    checking.add_argument("--keep", type=Path, metavar="TO", help="write the manifest of the files that agree")
    checking.set_defaults(part=_check)

    exporting = parts.add_parser("export", help="write a problem in the format of another program")
    exporting.add_argument("problem", type=Path, metavar="PROBLEM.npz", help="a frozen problem")
    exporting.add_argument(
        "--format", required=True, help="mat, qpsolvers, mps, mtx, siconos; with friction mtx, fclib"
    )
    exporting.add_argument("--out", type=Path, required=True, metavar="FILE", help="file to write")
    exporting.set_defaults(part=_export)

    importing = parts.add_parser("import", help="convert a linear complementarity problem of Siconos")
    importing.add_argument("source", type=Path, metavar="FILE.dat", help="n, format, M and q, as written by Siconos")
    importing.add_argument("--out", type=Path, required=True, metavar="PROBLEM.npz", help="file to write")
    importing.set_defaults(part=_import)

    judging = parts.add_parser("judge", help="recompute the claims of an answer")
    judging.add_argument("problem", type=Path, metavar="PROBLEM.npz", help="a frozen problem")
    judging.add_argument(
        "answer", type=Path, metavar="ANSWER", help=".npz or .json with du and pressure, or du, normal and friction"
    )
    judging.add_argument("--tolerance", type=float, help="required accuracy, default 1e-8")
    judging.set_defaults(part=_judge)


def run_problems(options: argparse.Namespace) -> int:
    """Run the part."""
    return int(options.part(options))


def _list(options: argparse.Namespace) -> int:
    for kept, shown, right, what in zip(
        _manifests(), (SHOWN, RUBBED), (5, 7), ("problems", "problems with friction"), strict=True
    ):
        rows = [tuple(map(str, row)) for row in kept[list(shown)].itertuples(index=False)]
        print("\n".join(columns([shown, *rows], right=range(1, right))))
        print(f"{len(kept)} {what}, {kept['bytes'].sum() / 1e6:.1f} MB: footprint problems make")
    return OK


def _manifests() -> tuple[pd.DataFrame, pd.DataFrame]:
    """Without friction, and with it."""
    from studies.arena.collected.frictional import FRICTIONAL
    from studies.arena.collected.rule import STEPS

    return STEPS.manifest(), FRICTIONAL.manifest()


def _make(options: argparse.Namespace) -> int:
    from studies.arena.collected.dataset import write_card
    from studies.arena.collected.frictional import FRICTIONAL, choose_frictional
    from studies.arena.collected.rule import STEPS, choose

    check_directory(options.out)
    smooth, rubbed = _manifests()
    done = count(1)
    with progress_bar("problems") as advance:

        def tell(name: str) -> None:
            advance(next(done), 0, name)

        if options.choose:
            tables = [choose(options.out, tell), choose_frictional(options.out, tell)]
            size = sum(table["bytes"].sum() for table in tables)
            print(f"{sum(map(len, tables))} problems, {size / 1e6:.1f} MB: {options.out}")
            return OK
        STEPS.make(options.out, smooth, tell)
        FRICTIONAL.make(options.out, rubbed, tell)
    wrong = _unlike(options.out, smooth, rubbed)
    if not wrong:
        write_card(options.out)
    return _say(wrong, len(smooth) + len(rubbed), options.out)


def _check(options: argparse.Namespace) -> int:
    from studies.arena.collected.dataset import altered
    from studies.arena.collected.rule import keep_agreeing

    if not options.directory.is_dir():
        raise UsageError(f"{options.directory} is not a directory: footprint problems make")
    smooth, rubbed = _manifests()
    if options.keep is not None:
        keep_agreeing(options.directory, smooth, options.keep)
    wrong = [*dict.fromkeys([*_unlike(options.directory, smooth, rubbed), *altered(options.directory)])]
    return _say(wrong, len(smooth) + len(rubbed), options.directory)


def _unlike(directory: Path, smooth: pd.DataFrame, rubbed: pd.DataFrame) -> list[str]:
    from studies.arena.collected.frictional import FRICTIONAL
    from studies.arena.collected.rule import STEPS

    return STEPS.unlike(directory, smooth) + FRICTIONAL.unlike(directory, rubbed)


def _say(wrong: list[str], planned: int, directory: Path) -> int:
    print("".join(f"{line}\n" for line in wrong), end="")
    print(f"{planned - len({line.partition(':')[0] for line in wrong})} of {planned} as the manifest says: {directory}")
    return FAILED if wrong else OK


def _export(options: argparse.Namespace) -> int:
    from studies.arena.collected.formats import export
    from studies.arena.replay import read_step

    step = read_step(options.problem)
    export(step, options.format, options.out)
    print(f"{len(step.r)} unknowns, {len(step.gap)} candidates: {options.out}")
    return OK


def _import(options: argparse.Namespace) -> int:
    from studies.arena.collected.candidates import of_complementarity
    from studies.arena.collected.formats import read_lcp
    from studies.output.atomic import write_by

    check_file(options.out)
    step = of_complementarity(*read_lcp(options.source))
    meta = {"name": options.source.stem, "source": options.source.name}
    write_by(options.out, FrozenStep(**{**vars(step), "meta": meta}).write)
    print(f"{len(step.r)} unknowns, {len(step.gap)} candidates: {options.out}")
    return OK


def _judge(options: argparse.Namespace) -> int:
    from studies.arena.replay import judge_files

    judgement = judge_files(options.problem, options.answer, options.tolerance)
    print("\n".join(judgement.lines()))
    return OK if judgement.sound else FAILED


def add_resolve(parser: argparse.ArgumentParser) -> None:
    """The file and how it is solved."""
    parser.add_argument("file", type=Path, metavar="FILE", help="a frozen problem, as solve --freeze writes it")
    parser.add_argument("--contact", default="semismooth", help="contact algorithm, see footprint list algorithms")
    parser.add_argument("--oracle", action="store_true", help="compare with a quadratic programme by cvxpy")


def run_resolve(options: argparse.Namespace) -> int:
    """Solve the step and print what the judge says."""
    from studies.arena.replay import algorithm_of, read_step, resolve_step
    from studies.scenes.plugins import blamed

    algorithm, step = algorithm_of(options.contact), read_step(options.file)
    with blamed(options.contact):
        replay = resolve_step(step, algorithm, ask_oracle=options.oracle)
    print("\n".join(replay.lines()))
    if not replay.solution.outcome.converged:
        return NOT_CONVERGED
    return OK if replay.sound else FAILED


ENVIRONMENT = Path(held_out.SECRET)  # of --held-out alone
TRUE = {True: "true", False: "false", None: "-"}


def add_tasks(parser: argparse.ArgumentParser) -> None:
    """The submission, the secret, and where the grades go."""
    help_text = "a table for each task: claim = 'met' or 'cannot', and the choices; without it the tasks are listed"
    parser.add_argument("submission", type=Path, nargs="?", metavar="FILE.toml", help=help_text)
    drawn = "grade also on hidden configurations, drawn from the secret in FILE, or in FOOTPRINT_ARENA_SECRET"
    parser.add_argument("--held-out", type=Path, nargs="?", const=ENVIRONMENT, metavar="FILE", help=drawn)
    limit = f"wall time of a task, all configurations together, default {LIMIT_S:g}"
    parser.add_argument("--limit", type=float, default=LIMIT_S, metavar="SECONDS", help=limit)
    parser.add_argument("--out", type=Path, metavar="FILE.json", help="write the grades as JSON")


def run_tasks(options: argparse.Namespace) -> int:
    """Print the tasks, or the grades; 1 where a claim is false."""
    if options.submission is None:
        if options.held_out is not None or options.out is not None or options.limit != LIMIT_S:
            raise UsageError("--held-out, --limit and --out need a submission: footprint tasks FILE.toml")
        print("\n".join(line for task in tasks().values() for line in task.lines))
        return OK
    limit_s, key = positive("limit", options.limit), None
    if options.out is not None:
        check_file(options.out)
        if options.out.resolve() == options.submission.resolve():
            raise UsageError(f"--out {options.out} is the submission")
    if options.held_out is not None:
        key = held_out.secret(None if options.held_out is ENVIRONMENT else options.held_out)
    claims, use = read_submission(options.submission), [str(Path(each).resolve()) for each in options.use or ()]
    try:
        with progress_bar("tasks") as tell:
            grades = grade(claims, key, limit_s=limit_s, tell=tell, use=use)
    except KeyboardInterrupt:
        print("footprint: interrupted; nothing is written", file=sys.stderr)
        return INTERRUPTED
    print("\n".join(_lines(grades)))
    if options.out is not None:
        about = {"submission": options.submission.name, "secret": "" if key is None else held_out.digest(key)}
        about |= {"score": sum(each.score for each in grades), "of": len(grades), "limit_s": limit_s}
        write_json(options.out, {**about, "tasks": list(map(asdict, grades)), "provenance": provenance()})
    return FAILED if any(each.score < 0 for each in grades) else OK


def _lines(grades: Sequence[Grade]) -> Iterator[str]:
    """A row a task, and the sum."""
    rows = [("task", "claim", "score", "open", "hidden", "")]
    for each in grades:
        hidden = "-" if each.hidden is None else f"{each.hidden} of {HIDDEN}"
        rows.append((each.task, each.claim or "-", str(each.score), TRUE[each.open], hidden, each.said))
    yield from columns(rows, right=range(2, 3))
    counts = Counter(each.score for each in grades)
    tally = f"{counts[1]} true, {counts[-1]} false, {counts[0]} without a claim"
    yield f"score {counts[1] - counts[-1]} of {len(grades)}: {tally}"
