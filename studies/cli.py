"""The command line ``footprint COMMAND``: picks the command and turns its errors into one line and an exit code.

What a command does is in :mod:`studies.commands`; only the module of the one that is asked for is imported.
"""

from __future__ import annotations

import argparse
import contextlib
import gc
import importlib
import os
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

from studies.ask.request import PartError, UsageError
from studies.commands import FAILED, INTERRUPTED, NOT_CONVERGED, OK, WRONG_USE
from studies.output import DISTRIBUTION
from studies.output.terminal import Escaping

__all__ = ["FAILED", "NOT_CONVERGED", "OK", "WRONG_USE", "main"]

COMMANDS = {  # the module of each, below studies.commands, and its help
    "list": ("parts", "list scenes, measures, algorithms and campaigns"),
    "show": ("parts", "show a scene, a measure or an algorithm with its settings"),
    "solve": ("solve", "solve one scene into a directory"),
    "choose": ("choose", "recommend measure, algorithm, element and mesh for a scene, with the price"),
    "sweep": ("sweep", "solve a scene for all combinations of one or two settings"),
    "resolve": ("problems", "solve one frozen contact problem again, alone, and judge it"),
    "export": ("exchange", "write a scene as a deck, a mesh or a neutral sheet for another program"),
    "problems": ("problems", "frozen contact problems for other programs, and a judge of their answers"),
    "leaderboard": ("bench_solvers", "write the ranking of solvers of frozen contact problems as a page"),
    "tasks": ("problems", "list the graded tasks, or grade a submission"),
    "judge-field": ("exchange", "compare the field or curve of another program with a scene's"),
    "run": ("campaigns", "solve the missing cells of a campaign"),
    "merge": ("campaigns", "merge the cells of another store, after recomputing their answers"),
    "table": ("campaigns", "print the cells of a campaign: requests and outcomes"),
    "time": ("campaigns", "time the converged cells of a campaign, one at a time"),
    "analyse": ("campaigns", "compute the tables of the pages"),
    "report": ("campaigns", "write the pages of a store"),
    "advise": ("advise", "look up the cheapest configuration of a scene that meets a tolerance"),
    "check": ("comparison", "compare a fresh campaign with the committed baseline"),
    "compare": ("comparison", "compare two stores, as a comment for a review or a page"),
    "card": ("parts", "judge a measure, element option, algorithm or solver on one page: laws, answers, costs"),
    "extremes": ("sweep", "solve and judge one point of a map of extremes"),
    "fuzz": ("sweep", "solve one random case again and check its laws"),
    "bench": ("bench", "time a solve and its growth, the harness, other programs and solvers"),
}
ENOUGH = 141  # as the shell has it of a process that a closed pipe ends
WITHOUT_PARTS = {"report", "compare", "leaderboard"}  # they read tables alone


class _Help(argparse.HelpFormatter):
    """Every option states its default; examples keep their lines."""

    def _get_help_string(self, action: argparse.Action) -> str | None:
        text, usual = action.help or "", action.default
        if usual is None or usual is argparse.SUPPRESS or usual in (False, "", []) or "default" in text:
            return text
        return f"{text}; default %(default)s"

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        return text if text.startswith("examples:") else super()._fill_text(text, width, indent)


class _Parser(argparse.ArgumentParser):
    """argparse, but an error is one line, and a minus before a digit begins a value: -8x8 and -1% are looked at."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **{"formatter_class": _Help, **kwargs})
        self._negative_number_matcher = re.compile(r"-\.?\d")

    def format_help(self) -> str:
        """With the examples of the command."""
        lines = [f"  {self.prog} {example}".rstrip() for example in examples().get(self.prog.partition(" ")[2], ())]
        self.epilog = "\n".join(["examples:", *lines]) if lines else ""
        return super().format_help()

    def error(self, message: str) -> NoReturn:
        print(f"{self.prog}: {message}", file=sys.stderr)
        raise SystemExit(WRONG_USE)


def examples() -> dict[str, list[str]]:
    """Lines that ``--help`` shows, by the words of a command."""
    import tomllib  # for --help alone

    return tomllib.loads((Path(__file__).parent / "commands" / "examples.toml").read_text(encoding="utf-8"))


class _Version(argparse.Action):
    """``--version``; the metadata are read only then."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from importlib.metadata import version

        print(f"footprint {version(DISTRIBUTION)}")
        parser.exit()


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command, its text free of control characters; returns the exit code."""
    streams = [stream and Escaping(stream) for stream in (sys.stdout, sys.stderr)]
    with contextlib.redirect_stdout(streams[0]), contextlib.redirect_stderr(streams[1]):
        try:
            code = _main(arguments)
            if sys.stdout is not None:
                sys.stdout.flush()
        except BrokenPipeError:  # the reader has closed the pipe: nothing more is printed, not at exit either
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return ENOUGH
        return code


def _main(arguments: Sequence[str] | None) -> int:
    # before numpy is loaded: threads of small matrices only wait for one another, 5 times as long on a busy machine;
    # OpenBLAS and MKL read this one unless their own variables are set
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    argv = sys.argv[1:] if arguments is None else arguments
    if arguments is None:  # one command a process: what is loaded now stays, so it is not searched for garbage
        gc.disable()
    try:
        _load_plugins(argv)
        options = _parser(argv).parse_args(argv)
        if arguments is None:
            gc.freeze()
            gc.enable()
        return int(options.run(options))
    except BrokenPipeError:
        raise
    except (UsageError, OSError) as error:
        print(f"footprint: {_line(error)}", file=sys.stderr)
        return WRONG_USE
    except PartError as error:
        print(f"footprint: {error}", file=sys.stderr)
        return FAILED
    except MemoryError as error:
        print(f"footprint: {_of_memory(error)}", file=sys.stderr)
        return FAILED
    except KeyboardInterrupt:
        print("footprint: interrupted; what was finished is kept", file=sys.stderr)
        return INTERRUPTED
    finally:
        if arguments is None:  # the process ends here: without this it takes a tenth of a small solve to tidy up first
            gc.freeze()


def _line(error: Exception) -> str:
    """The message of an error; of a system error the file first, without its number."""
    if isinstance(error, OSError) and error.strerror:
        return error.strerror if error.filename is None else f"{error.filename}: {error.strerror}"
    return str(error)


def _of_memory(error: MemoryError) -> str:
    """The message of a memory error."""
    return " ".join(f"not enough memory; a coarser mesh needs less: {error}".removesuffix(": ").split())


def _load_plugins(argv: Sequence[str]) -> None:
    """Parts from outside come into the catalogues before a command is imported that may list them."""
    early = _Parser(prog="footprint", add_help=False, allow_abbrev=False)
    early.add_argument("--use", action="append", default=[])
    files = early.parse_known_args(argv)[0].use
    if files or next(iter(argv), None) in {*COMMANDS} - WITHOUT_PARTS:
        from studies.scenes.plugins import load

        load(files)


def _parser(arguments: Sequence[str]) -> argparse.ArgumentParser:
    """Parser of all commands, with the arguments of the one that is asked for."""
    parser = _Parser(prog="footprint", description="Compare shell strain measures and contact algorithms.")
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version")
    commands = parser.add_subparsers(required=True, parser_class=_Parser, metavar="COMMAND")
    for name, (place, text) in COMMANDS.items():
        command = commands.add_parser(name, help=text, description=text)
        if name == next(iter(arguments), None):
            module = importlib.import_module(f"studies.commands.{place}")
            function = name.replace("-", "_")
            getattr(module, f"add_{function}")(command)
            command.add_argument(
                "--use",
                action="append",
                metavar="FILE.py",
                help="load your own measures, algorithms, scenes or solvers",
            )
            command.set_defaults(run=getattr(module, f"run_{function}"))
    return parser


if __name__ == "__main__":
    sys.exit(main())
