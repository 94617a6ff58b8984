"""``footprint tasks``: runs that go wrong, and a submission of what to choose instead, graded claim by claim."""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

from studies.arena import held_out
from studies.arena.tasks.catalogue import HIDDEN, tasks
from studies.arena.tasks.grading import LIMIT_S, Grade, grade
from studies.arena.tasks.submission import read_submission
from studies.ask.request import UsageError
from studies.commands import FAILED, INTERRUPTED, OK
from studies.commands.options import check_file, positive, progress_bar
from studies.output.atomic import write_json
from studies.output.provenance import provenance
from studies.output.terminal import columns

ENVIRONMENT = Path(held_out.SECRET)  # of --held-out alone
TRUE = {True: "true", False: "false", None: "-"}


def add_tasks(parser: argparse.ArgumentParser) -> None:
    """The submission, the secret, and where the grades go."""
    help_text = "a table a task: claim = 'met' or 'cannot', and what is chosen; left out: the tasks"
    parser.add_argument("submission", type=Path, nargs="?", metavar="FILE.toml", help=help_text)
    drawn = "grade on hidden configurations, too, drawn from the secret in a file, or in FOOTPRINT_ARENA_SECRET"
    parser.add_argument("--held-out", type=Path, nargs="?", const=ENVIRONMENT, metavar="FILE", help=drawn)
    limit = f"wall time of a task with all its configurations, default {LIMIT_S:g}"
    parser.add_argument("--limit", type=float, default=LIMIT_S, metavar="SECONDS", help=limit)
    parser.add_argument("--out", type=Path, metavar="FILE.json", help="the grades as JSON")


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
