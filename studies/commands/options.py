"""Options that several commands share, and the checks of their values."""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from studies.ask.request import UsageError
from studies.output.terminal import behind, printable
from studies.scenes import SCENES

if TYPE_CHECKING:
    from studies.scenes.mesh_file.scene import DeckScene

SCENE = "a scene of footprint list scenes, or a mesh: FILE.inp of Abaqus or CalculiX, FILE.msh of gmsh"
SETTINGS = "a setting of the scene or the algorithm, see footprint show SCENE; may be repeated"
FILES = (".inp", ".msh")  # what the name of a deck of Abaqus or CalculiX ends in, and of a mesh of gmsh
NO_FOUNDATION = "none"
STORE = Path(".footprint/store")
SAME_LINE = "\r\x1b[2K"  # to its beginning, and empty it


def add_store(parser: argparse.ArgumentParser) -> None:
    """``--store DIR``."""
    parser.add_argument("--store", type=Path, default=STORE, metavar="DIR", help="directory of cells and tables")


def add_trust(parser: argparse.ArgumentParser) -> None:
    """``--trust``."""
    parser.add_argument("--trust", action="store_true", help="import the modules that a campaign file names")


def add_solving(parser: argparse.ArgumentParser, contact: str, mesh: str) -> None:
    """A scene and how it is solved; contact, mesh: the help of these two."""
    parser.add_argument("scene", help=SCENE)
    parser.add_argument("--contact", default="semismooth", help=contact)
    parser.add_argument("--newton", default="mixed", help="iteration: plain, or mixed, which extrapolates resultants")
    parser.add_argument("--mesh", help=mesh)
    add_model(parser)
    parser.add_argument("--steps", type=int, default=1, help="load steps between two requested loads")


def add_model(parser: argparse.ArgumentParser) -> None:
    """``--model NAME``."""
    parser.add_argument("--model", default="auto", help="part of the body that is solved, see footprint show SCENE")


def named(options: argparse.Namespace, *names: str) -> dict[str, Any]:
    """Options by name."""
    return {name: getattr(options, name) for name in names}


def check_directory(path: Path) -> None:
    """Raise UsageError for an --out that cannot be a directory."""
    if path.exists() and not path.is_dir():
        raise UsageError(f"--out {path} is a file, not a directory")


def check_file(path: Path, option: str = "--out") -> None:
    """Raise UsageError for an option that cannot be a file: what is there is replaced, and may only be one."""
    if path.is_dir():
        raise UsageError(f"{option} {path} is a directory, not a file")
    if path.is_symlink() or (path.exists() and not path.is_file()):
        raise UsageError(f"{option} {path} is a link or a device, not a file")


def add_settings(parser: argparse.ArgumentParser) -> None:
    """``--set KEY=VALUE``, as often as wanted."""
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="settings", help=SETTINGS)


def pairs(settings: Sequence[str]) -> dict[str, str]:
    """Keys and values of ``--set KEY=VALUE``; raises UsageError."""
    given: dict[str, str] = {}
    for pair in settings:
        key, separator, value = pair.partition("=")
        if not separator:
            raise UsageError(f"--set {pair!r} must be KEY=VALUE")
        given[key] = value
    return given


def positive(name: str, value: float, most: float = math.inf) -> float:
    """The value, if it is positive, finite and at most ``most``; raises UsageError."""
    if not (0 < value <= most and math.isfinite(value)):
        raise UsageError(f"{name} = {value} must be a number in (0, {most:g}{']' if math.isfinite(most) else ')'}")
    return value


def count(name: str, value: int) -> int:
    """The value, if it is in [1, 1000]; raises UsageError."""
    if not 1 <= value <= 1000:
        raise UsageError(f"{name} = {value} must be a whole number in [1, 1000]")
    return value


@contextmanager
def reading(store: Path) -> Iterator[None]:
    """Cells that have what their types allow, and lack what is computed with, as those of others may: one line."""
    try:
        yield
    except UsageError:
        raise
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())[:300]
        raise UsageError(f"{store}: its cells were not written by a campaign: {reason}") from error


@contextmanager
def of_file(scene: str, settings: Sequence[str]) -> Iterator[DeckScene | None]:
    """Told on the terminal, and in the catalogue as long as it lasts, where it names a file; else None.

    settings: of ``--set``, by which it is pressed on a foundation or not. Raises UsageError for what is not a deck, and
    OSError.
    """
    if not scene.lower().endswith(FILES) or scene in SCENES:
        yield None
        return
    from studies.scenes.mesh_file.scene import entered  # only who has a deck waits for its reader

    pressed = pairs(settings).get("foundation", NO_FOUNDATION) != NO_FOUNDATION
    with entered(scene, on_foundation=pressed) as deck:
        print("\n".join(deck.told()))
        yield deck


@contextmanager
def progress_bar(name: str) -> Iterator[Callable[[int, int, str], None]]:
    """Say on the terminal what is being done, how much of it is done, and when the rest will be, as far as is known.

    The function takes (done, planned, label); none are planned where nobody knows how many there are.
    """
    start = time.perf_counter()
    with progress_line() as tell:

        def advance(done: int, planned: int, label: str) -> None:
            spent, rest = time.perf_counter() - start, planned - done
            left = f", about {spent / done * rest:.2g} s left" if done > 0 and rest > 0 else ""
            tell(f"{name}: {label}, {done} of {planned or '?'}{left}")

        yield advance


@contextmanager
def progress_line(whole: float = math.inf) -> Iterator[Callable[[str], None]]:
    """Say on the terminal what has been reached, and the seconds so far, of the ``whole`` if there is a bound.

    Where there is no terminal, nothing, and nothing is loaded for it.
    """
    if not sys.stderr.isatty():
        yield lambda text: None
        return
    bound = f" of {whole:g} s" if math.isfinite(whole) else " s so far"
    terminal, start = behind(sys.stderr), time.perf_counter()

    def tell(text: str) -> None:
        spent = time.perf_counter() - start
        print(f"{SAME_LINE}{printable(text)}; {spent:.1f}{bound}", end="", file=terminal, flush=True)

    try:
        yield tell
    finally:
        print(SAME_LINE, end="", file=terminal, flush=True)
