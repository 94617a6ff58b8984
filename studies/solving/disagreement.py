"""Why two certified states of one problem differ, by facts of both states alone."""

from __future__ import annotations

from dataclasses import dataclass

LOAD_STEPS = "load steps"  # with friction the path decides, and it was followed in other steps
BEYOND = "beyond uniqueness"  # with friction and in as many steps: its law alone does not leave one answer
UNSTABLE = "not both are stable"  # one is an equilibrium that nothing can stand in, or was reached through one
SYMMETRY = "broken symmetry"  # a part by symmetry cannot leave the symmetry that the whole has left
BRANCHES = "two stable branches"  # without friction, both stable, both by the same model
ASYMMETRIES = ("central", "mirror")
SYMMETRIC = 1e-6  # of the largest pressure: less is not a broken symmetry


@dataclass(frozen=True)
class Facts:
    """What is known of a state.

    steps: equal where two paths are cut alike.  asymmetry: of its pressure, by the ASYMMETRIES.
    """

    friction: bool
    steps: object
    stable: bool
    model: str = "full"
    asymmetry: tuple[float, ...] = ()


def why(one: Facts, other: Facts) -> str:
    """Why two certified states of one problem differ, in one of the words above."""
    if one.friction and one.steps != other.steps:
        return LOAD_STEPS
    if not (one.stable and other.stable):
        return UNSTABLE
    both = zip(one.asymmetry, other.asymmetry, strict=False)
    broken = any((mine <= SYMMETRIC) != (theirs <= SYMMETRIC) for mine, theirs in both)
    if one.model != other.model and broken:
        return SYMMETRY
    return BEYOND if one.friction else BRANCHES
