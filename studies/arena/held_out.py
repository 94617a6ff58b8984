"""The held-out tier, on which no solver can be tuned: problems drawn from a secret, in memory only.

Nothing is written: a judge with the secret draws the same problems again. Results contain the number of solved problems
and a digest of the secret, which identifies results of the same secret without revealing it.

Families: ``relief``, a membrane over random waves, which the collection does not have; ``panel`` and ``ring``, scenes
that it has, with settings that are drawn. A problem is taken when its answer is certified by two methods, as in the
collection. BLAS kernels differ between machines, so that no problem may depend on the last digit: only the first
iterates of a path are used, as later ones depend on how steps were cut, and the last step is mere rounding.
"""

from __future__ import annotations

import hmac
import math
import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np

from contact.interchange.linearised_step import FrozenStep
from contact.interchange.untrusted import read_bytes
from studies.arena.collected.candidates import Path as Walk
from studies.arena.collected.candidates import frozen, on_path
from studies.arena.collected.certified import confirm, find
from studies.arena.collected.collection import Tell, silent
from studies.arena.collected.rule import condition
from studies.ask.request import UsageError
from studies.experiments.obstacles import obstacle

SECRET = "FOOTPRINT_ARENA_SECRET"
SHORTEST, LONGEST = 16, 1024  # bytes of a secret: a shorter one can be guessed from its digest
EACH = 6  # problems of a family
TRIES = 5  # draws for each problem
WAVES = 4
EARLY = 2  # iterates of the first load step
Draw = Callable[[np.random.Generator], FrozenStep]


def secret(file: Path | None = None) -> bytes:
    """From a file, or from the environment; raises UsageError, and OSError where there is no file."""
    if file is None:
        value, source = os.environ.get(SECRET, "").encode("utf-8", "surrogateescape"), SECRET
        if not value:
            raise UsageError(f"the held-out tier needs a secret: --held-out FILE, or the variable {SECRET}")
    else:
        try:
            value, source = read_bytes(file, LONGEST).strip(), str(file)
        except ValueError as error:
            raise UsageError(f"{file} is not a secret: {error}") from None
    if not SHORTEST <= len(value) <= LONGEST:
        raise UsageError(f"{source}: a secret of {len(value)} bytes must have {SHORTEST} to {LONGEST}")
    return value


def digest(key: bytes) -> str:
    """Identifies results of the same secret."""
    return _mac(key, "digest").hex()[:16]


def problems(key: bytes, each: int = EACH, tell: Tell = silent) -> dict[str, FrozenStep]:
    """The problems of a secret by name: ``each`` of a family, fewer where draws have no certified answer."""
    steps: dict[str, FrozenStep] = {}
    for family, draw in FAMILIES.items():
        for i in range(each):
            name = f"{family}-{i + 1}"
            tell(name)
            rngs = (generator(key, f"{name} {again}") for again in range(TRIES))
            step = next(_certified(draw, rngs), None)
            steps |= {} if step is None else {name: step}
    return steps


def _certified(draw: Draw, rngs: Iterable[np.random.Generator]) -> Iterator[FrozenStep]:
    """The drawn steps whose answer two methods agree on."""
    for rng in rngs:
        with suppress(ArithmeticError):
            step = draw(rng)
            confirm(step, find(step), condition(step.K))
            yield step


def generator(key: bytes, what: str) -> np.random.Generator:
    """The random numbers of a secret for one thing that is drawn."""
    return np.random.default_rng(list(_mac(key, what)))


def _mac(key: bytes, what: str) -> bytes:
    return hmac.digest(key, f"footprint held out 2: {what}".encode(), "sha256")


def _relief(rng: np.random.Generator) -> FrozenStep:
    """A membrane under a load of either sign over waves of random length, direction and height."""
    body = obstacle("OBSTCLAL", int(rng.integers(8, 32)))
    points = math.isqrt(len(body.f))
    s, t = (x.ravel() for x in np.meshgrid(*[np.arange(1, points + 1) / (points + 1)] * 2, indexing="ij"))
    waves = rng.uniform(-9, 9, (WAVES, 2))
    heights, phases = rng.uniform(0.02, 0.3, WAVES), rng.uniform(0, 2 * np.pi, WAVES)
    low = np.sin(np.outer(s, waves[:, 0]) + np.outer(t, waves[:, 1]) + phases) @ heights - rng.uniform(0, 0.3)
    return frozen(replace(body, f=body.f * rng.uniform(-20, 5), low=low))


def _panel(rng: np.random.Generator) -> FrozenStep:
    settings = {
        "shape": str(rng.choice(["cylinder", "sphere", "plate"])),
        "foundation": str(rng.choice(["plane", "ball"])),
        "h_over_R": repr(float(10 ** rng.uniform(-2.7, -1))),
        "aspect": repr(float(10 ** rng.uniform(-0.7, 0.7))),
        "E_ratio": repr(float(10 ** rng.uniform(0, 2))),
        "gamma_deg": repr(float(rng.uniform(0, 90))),
        "delta_mm": repr(float(10 ** rng.uniform(-1, 0.5))),
    }
    n = int(rng.integers(3, 9))
    return _one_of(rng, Walk("panel", f"{n}x{n}", settings))


def _ring(rng: np.random.Generator) -> FrozenStep:
    settings = {"h_mm": repr(float(10 ** rng.uniform(-0.3, 1))), "delta_mm": repr(float(rng.uniform(1, 40)))}
    return _one_of(rng, Walk("ring", f"1x{4 * int(rng.integers(3, 12))}", settings))


def _one_of(rng: np.random.Generator, walk: Walk) -> FrozenStep:
    """One of the first iterates along a path; raises ArithmeticError where it has none with candidates."""
    steps = [each.step for each in islice(on_path(walk), EARLY) if len(each.step.gap)]
    if not steps:
        raise ArithmeticError("no iterate has a candidate")
    return steps[int(rng.integers(len(steps)))]


FAMILIES: dict[str, Draw] = {"relief": _relief, "panel": _panel, "ring": _ring}
