"""``footprint resolve``: one frozen contact problem again, alone, judged."""

from __future__ import annotations

import argparse
from pathlib import Path

from studies.arena.replay import algorithm_of, read_step, resolve_step
from studies.ask.scene import UsageError
from studies.commands import FAILED, NOT_CONVERGED, OK
from studies.scenes.plugins import blamed


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The file and how it is solved."""
    parser.add_argument("file", type=Path, metavar="FILE")
    parser.add_argument("--contact", default="semismooth")
    parser.add_argument("--epsilon", type=float, help="regularisation, MPa/mm; default that of the algorithm")
    parser.add_argument("--oracle", action="store_true", help="compare with a quadratic programme by cvxpy")


def run(options: argparse.Namespace) -> int:
    """Solve the step and print what the judge says."""
    if options.epsilon is not None and not options.epsilon > 0:
        raise UsageError(f"epsilon = {options.epsilon} must be a number in (0, inf]")
    algorithm, step = algorithm_of(options.contact, options.epsilon), read_step(options.file)
    with blamed(options.contact):
        found = resolve_step(step, algorithm, ask_oracle=options.oracle)
    print("\n".join(found.lines()))
    if not found.solution.outcome.converged:
        return NOT_CONVERGED
    return OK if found.sound else FAILED
