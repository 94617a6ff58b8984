"""The steps with friction of the collection, family by family, and the rule by which they are selected.

Bars and the plate along a path of load steps, rigid bodies, springs with one answer and with several, a tyre pressed
and dragged, random steps, and small public problems. A step is taken when an algorithm has an answer that passes the
judge and the equations on its states confirm it; the oracle is a third check where it converges. The others are listed
with their reasons. The manifest is separate from that of the steps without friction.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from contact.algorithms.semismooth import Semismooth
from contact.continuation.friction_path import PathState, Stage, follow
from contact.coulomb import State
from contact.interchange.linearised_step import FrozenFrictionalStep, freeze
from contact.interchange.own_ways import with_own_ways
from contact.problem import ContactProblem, ContactSolution
from studies.arena.collected.certified import confirm_with_friction, find_with_friction
from studies.arena.collected.collection import LEFT_OUT, Candidate, Collection, Tell, silent, sums, write
from studies.arena.collected.rule import condition, kind
from studies.arena.frictional_steps import dense_step, random_step, tyre_drag
from studies.experiments.friction.bars import Bar
from studies.experiments.friction.greco import GrecoPlate
from studies.experiments.friction.public_problems import small, source

RADIUS, TENSION = 100.0, 10.0  # mm, N: of drums
SOFT = 1.0  # N/mm: springs that are unloaded until a rigid body slides
DRIVEN = 10.0  # mm: displacement that causes gross slip
SEEDS = range(10)
Rubbed = Candidate[FrozenFrictionalStep]


def _on_path(
    family: str,
    name: str,
    stage_at: Callable[[float, np.ndarray], Stage],
    loads: Sequence[float],
    rest: PathState,
    source: str,
) -> Iterator[Rubbed]:
    """The first linearised step towards each of the loads in turn."""
    before = rest
    for i, load in enumerate(loads, 1):
        stage, at = stage_at(load, before.anchors), before.solution
        step = _frozen(stage.problem, at)
        yield Candidate(family, f"{name}-s{i}", {"source": source, "target": load}, step)
        if i < len(loads):
            before = next(follow(stage_at, (load,), Semismooth(settle=0.0), before))


def _frozen(problem: ContactProblem, at: ContactSolution) -> FrozenFrictionalStep:
    """Of a problem with friction."""
    step = freeze(problem, at.u, at.pressure, {})
    assert isinstance(step, FrozenFrictionalStep)
    return step


def strips() -> Iterator[Rubbed]:
    """Pulled, released, and pushed back: the anchors carry the slip zones of the previous steps."""
    for n, pulls in ((25, (20.0, 0.0, -20.0)), (100, (20.0, 0.0, -20.0)), (200, (20.0,))):
        bar = Bar(n, 100.0, 1.0, press=0.5)
        description = "strip pulled over a plane, in partial slip"
        yield from _on_path("strip", f"strip-friction-{n}", bar.stage_at, pulls, bar.rest, description)


def drums() -> Iterator[Rubbed]:
    """Pulled at one end beyond the tension, and half released."""
    for n in (25, 50, 100):
        bar = Bar(n, 2 * RADIUS, 0.3, curvature=1 / RADIUS, tension=TENSION, held=True)
        description = "strip on a drum, in partial slip"
        yield from _on_path("drum", f"drum-{n}", bar.stage_at, (5.0, 2.5), bar.rest, description)


def capstans() -> Iterator[Rubbed]:
    """Strips on drums in gross slip."""
    for n, mu, wrap in ((25, 0.2, 1.0), (25, 0.5, 2.0), (50, 0.5, 4.0), (100, 0.3, 2.0)):
        bar = Bar(n, RADIUS * wrap, mu, curvature=1 / RADIUS, tension=TENSION, driven=True)
        name = f"capstan-{n}-mu{mu:g}-wrap{wrap:g}"
        yield from _on_path("capstan", name, bar.stage_at, (DRIVEN,), bar.rest, "strip on a drum, in gross slip")


def plates() -> Iterator[Rubbed]:
    """The GRECO plate, with open, slipping and sticking candidates."""
    for element, n, mu in (("Q2", 8, 1.0), ("Q2", 16, 1.0), ("Q2", 16, 0.3), ("Q1", 16, 1.0), ("Q2", 32, 1.0)):
        plate = GrecoPlate(element, n)
        step = _frozen(plate.problem(mu), ContactSolution.at_rest(len(plate.free), len(plate.x)))
        name = f"greco-{element}-{n}-mu{mu:g}"
        yield Candidate("greco", name, {"source": "GRECO plate with friction, SSNV128"}, step)


def rigid_bodies() -> Iterator[Rubbed]:
    """A block on a slope of tangent 0.1 that is pushed, and on one of 26.565 degrees that is not."""
    wedge, slope = math.atan(0.1), math.radians(26.565)
    for name, angle, mu, push in (
        ("wedge-sticks", wedge, 0.3, 0.41),
        ("wedge-slides", wedge, 0.3, 0.42),
        ("slope-slides", slope, 0.49, 0.0),
        ("slope-sticks", slope, 0.5, 0.0),
    ):
        up, off = (math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))
        load, S = np.array([push, -1.0]), np.array([up, (0.0, 0.0)])
        arrays = SOFT * np.eye(2), -load, np.array([off]), np.zeros(1), S, np.zeros((1, 2)), np.array([mu])
        yield Candidate("rigid", name, {"source": "rigid block on a slope, CGS-4"}, dense_step(*arrays))


def springs() -> Iterator[Rubbed]:
    """Klarbring's node on coupled springs, [[2, -1], [-1, 1]]: above mu = 2 answers may be three, or none."""
    G, S = np.array([[0.0, 1.0]]), np.array([[1.0, 0.0], [0.0, 0.0]])
    K = np.array([[2.0, -1.0], [-1.0, 1.0]])
    for mu, along, across in (
        (0.2, 1.0, -1.0),
        (0.8, 0.1, -1.0),
        (0.8, 3.0, -2.0),
        (0.8, -1.0, -1.0),
        (3.0, 2.5, -1.0),
    ):
        arrays = K, -np.array([along, across]), G, np.zeros(1), S, np.zeros((1, 2)), np.array([mu])
        name = f"springs-mu{mu:g}-{along:g}-{across:g}"
        yield Candidate("springs", name, {"source": "Klarbring 1990"}, dense_step(*arrays))


def random_steps() -> Iterator[Rubbed]:
    """Small random steps, each with every state."""
    for seed in SEEDS:
        yield Candidate("random", f"random-{seed}", {"source": f"seed {seed}"}, random_step(seed))


def public() -> Iterator[Rubbed]:
    """Problems of Siconos, with separate unknowns for each contact."""
    whence, licence = source()
    for name, problem in small().items():
        step = with_own_ways(problem)
        yield Candidate("siconos", f"friction-{name.rpartition('.')[0]}", {"source": whence}, step, licence)


def tyres() -> Iterator[Rubbed]:
    """A tyre pressed on a plane, which is then dragged."""
    for mesh, drags in (("12x10", (1.0, 4.0)), ("28x26", (0.5, 1.0, 2.0, 4.0, 8.0))):
        drag = tyre_drag(mesh)
        name, description = f"tyre-drag-{mesh}", "tyre pressed on a plane that is dragged"
        yield from _on_path("tyre-drag", name, drag.stage_at, (0.0, *drags), drag.rest, description)


FAMILIES: dict[str, Callable[[], Iterator[Rubbed]]] = {
    "rigid": rigid_bodies,
    "springs": springs,
    "siconos": public,
    "random": random_steps,
    "strip": strips,
    "drum": drums,
    "capstan": capstans,
    "greco": plates,
    "tyre-drag": tyres,
}


def row(candidate: Rubbed) -> dict[str, Any]:
    """A row of the manifest without the size of the file; raises NotCertifiedError."""
    step = candidate.step
    stiff = condition(step.K)
    answer = confirm_with_friction(step, find_with_friction(step), stiff)
    known, counts = answer.known, np.bincount(answer.known.state, minlength=len(State))
    record = {"name": candidate.name, "family": candidate.family, "unknowns": len(step.r)}
    record |= {"candidates": len(step.mu), "entries": step.K.nnz, "kind": kind(step), "condition": stiff}
    record |= {"friction": "coulomb", "mu": float(np.max(step.mu))}
    record |= dict(zip(("open", "sticking", "slipping"), map(int, counts), strict=True))
    record |= {"force_N": float(known.normal.sum()), "friction_N": float(np.linalg.norm(known.friction, axis=1).sum())}
    record |= {"displacement_mm": float(np.max(np.abs(known.du), initial=0.0))}
    record |= {"found_by": answer.found_by, "confirmed_by": " and ".join(answer.confirmed_by)}
    return record | {"several": answer.several, "licence": candidate.licence, **sums(step), **candidate.origin}


def choose_frictional(directory: Path, tell: Tell = silent, only: str = "") -> pd.DataFrame:
    """Apply the rule: write all files, the manifest and the list of those left out; only: a family, default all."""
    rows, gone = [], []
    for candidate in _of([only] if only else FAMILIES):
        tell(candidate.name)
        try:
            record = row(candidate)
        except ArithmeticError as error:  # NotCertifiedError, and what a singular step raises
            gone.append(dict(zip(LEFT_OUT, (candidate.name, candidate.family, str(error)), strict=True)))
            continue
        rows.append(record | {"bytes": write(directory, candidate).stat().st_size})
    return FRICTIONAL.write_choice(directory, rows, gone)


def _of(families: Iterable[str]) -> Iterator[Rubbed]:
    for family in families:
        yield from FAMILIES[family]()


def _sizes(row: Mapping[Hashable, Any], step: FrozenFrictionalStep) -> dict[str, float]:
    """A residual is accurate relative to the forces in balance, gap and slip relative to the displacement."""
    moved = float(row["displacement_mm"])
    return {"sum_r": step.scale, "sum_gap": moved, "sum_slip": moved}


FRICTIONAL = Collection(
    "frictional.csv",
    "frictional-left-out.csv",
    FrozenFrictionalStep.read,
    _sizes,
    lambda kept: _of(kept["family"].unique()),
)
