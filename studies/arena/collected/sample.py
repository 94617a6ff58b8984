"""A short list of certified frozen problems, about twenty small ones, made in a few seconds: what a card is tried on.

They are taken by the rule of the collection from a few of its paths; no file is read or written, and nobody is judged.
"""

from __future__ import annotations

from functools import lru_cache

from studies.arena.collected.candidates import Candidate, candidates
from studies.arena.collected.paths import Path
from studies.arena.collected.rule import Rule, Taken

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


@lru_cache(maxsize=1)
def sample() -> tuple[Taken, ...]:
    """The problems with their certified answers, always the same in the same order."""
    rule = Rule()
    taken = (rule.taken(each) for each in candidates(PATHS) if _wanted(each))
    return tuple(each for each in taken if each is not None)


def _wanted(candidate: Candidate) -> bool:
    return "scene" in candidate.origin or candidate.name in PUBLISHED
