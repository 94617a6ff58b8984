"""The problems of a card: a frozen sample, problems made from their answer, small scenes, and hard points of scenes.

The sample, about twenty small steps made in a few seconds, is taken by the rule of the collection from a few of its
paths. All are the same for everybody who is tried; nobody is tried here.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from contact.interchange.linearised_step import FrozenStep, freeze
from contact.problem import ContactProblem, ContactSolution, Outcome
from studies.arena.collected.candidates import candidates
from studies.arena.collected.paths import Path
from studies.arena.collected.rule import Rule, Taken
from studies.fuzz import matrices

FROZEN, MADE, SCENE, HARD = "frozen", "made", "scene", "hard"
GROUPS = {
    FROZEN: "frozen steps of the collection",
    MADE: "random matrices made from their answer",
    SCENE: "small scenes",
    HARD: "hard points",
}
CASES = range(24)  # of random matrices
PUBLISHED = ("OBSTCLAL-10", "OBSTCLBL-10", "TORSION-c5-10", "Murty-10", "Fathi-10", "Csizmadia-10")
PATHS = (
    Path("strip-contact", "4x1", {"lam_over_a": "0.1"}),
    Path("ring", "1x16", {"h_mm": "1", "delta_mm": "1,35,50"}),
    Path("panel", "6x6"),
    Path("panel", "6x6", {"foundation": "ball"}),
    Path("panel", "6x6", {"E_ratio": "1000"}),
    Path("panel", "6x6", {"inflation": "1", "load": "follower"}),
    Path("panel", "6x6", {"shape": "plate"}),
    Path("tyre", "6x6", {"load": "follower", "delta_mm": "5,20"}, looks=2),
    Path("tyre", "6x6", {"delta_mm": "5,20"}, looks=2),  # an indefinite tangent
    Path("tyre", "6x6", {"coupling": "consistent", "delta_mm": "5,20"}, looks=2),
)


@dataclass(frozen=True, eq=False)
class Posed:
    """A contact problem alone, its answer, and the step that it is from, if it is frozen."""

    group: str
    name: str
    problem: ContactProblem
    answer: ContactSolution
    step: FrozenStep | None = None


@dataclass(frozen=True)
class Asked:
    """A request of a scene; why: what is hard about it."""

    group: str
    scene: str
    mesh: str
    settings: Mapping[str, str] = field(default_factory=dict)
    why: str = ""

    @property
    def name(self) -> str:
        """The request as one line, after what is hard about it."""
        told = " ".join([self.scene, self.mesh, *(f"{key}={value}" for key, value in self.settings.items())])
        return f"{self.why}: {told}" if self.why else told


SMALL = (
    Asked(SCENE, "strip-contact", "8x1"),
    Asked(SCENE, "heavy-strip", "8x1"),
    Asked(SCENE, "plate-contact", "8x1"),
    Asked(SCENE, "ring", "1x16", {"delta_mm": "1,35"}),
    Asked(SCENE, "panel", "6x6"),
    Asked(SCENE, "panel", "6x6", {"foundation": "ball"}),
    Asked(SCENE, "tyre", "6x6", {"delta_mm": "5,20"}),
    Asked(SCENE, "tyre", "6x6", {"delta_mm": "5,20", "coupling": "consistent"}),
)
POINTS = (
    Asked(HARD, "panel", "4x4", {"h_over_R": "0.001"}, "very thin"),
    Asked(HARD, "panel", "4x4", {"E_ratio": "1000"}, "stiff ratio"),
    Asked(HARD, "panel", "4x4", {"nu": "0.49999"}, "nearly incompressible"),
    Asked(HARD, "panel", "4x4", {"shape": "plate", "delta_mm": "0"}, "touch without pressure"),
    Asked(HARD, "panel", "4x4", {"shape": "plate", "delta_mm": "1e-08"}, "hardly a travel"),
    Asked(HARD, "panel", "4x4", {"shape": "plate", "delta_mm": "0", "inflation": "0.1"}, "contact everywhere"),
    Asked(HARD, "panel", "4x4", {"foundation": "ball", "ball_mm": "0.1", "delta_mm": "0.5"}, "one node"),
    Asked(HARD, "panel", "4x4", {"delta_mm": "5"}, "a large step"),
    Asked(HARD, "tyre", "6x6", {"delta_mm": "20", "p0_MPa": "0.05"}, "indefinite tangent"),
    Asked(HARD, "tyre", "6x6", {"delta_mm": "20", "load": "follower"}, "follower load"),
)
BENT = (Asked(SCENE, "cantilever", "8x1"), Asked(SCENE, "hemisphere", "6x6"))  # without contact


@lru_cache(maxsize=1)
def sample() -> tuple[Taken, ...]:
    """Frozen problems with their certified answers, always the same in the same order."""
    rule = Rule()
    wanted = (each for each in candidates(PATHS) if "scene" in each.origin or each.name in PUBLISHED)
    return tuple(taken for taken in map(rule.taken, wanted) if taken is not None)


def posed(epsilon: float) -> Iterator[Posed]:
    """The frozen sample, and random matrices whose answers obey the law of an epsilon [MPa/mm]."""
    yield from frozen()
    yield from made(epsilon)


def frozen() -> Iterator[Posed]:
    """The sample with its certified answers."""
    for taken in sample():
        step, found = taken.candidate.step, taken.answer
        answer = ContactSolution(found.du, found.pressure, found.pressed, Outcome.CONVERGED)
        yield Posed(FROZEN, taken.candidate.name, step.problem(), answer, step)


def made(epsilon: float) -> Iterator[Posed]:
    """Random matrices, a number each; see :mod:`studies.fuzz.matrices`."""
    for seed in CASES:
        yield Posed(MADE, f"matrices {seed}", *matrices.made(seed, epsilon))


def frozen_of(case: Posed) -> FrozenStep:
    """The step of a problem that is linear in its displacements."""
    return case.step or freeze(case.problem, np.zeros_like(case.answer.u), np.zeros_like(case.answer.pressure), {})
