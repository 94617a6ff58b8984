"""The scenes that other programs solve from our decks."""

from __future__ import annotations

from studies.bench.peers.catalogue import FOLLOWER
from studies.bench.peers.problems import DELTA_MM
from studies.bench.programs.case import Case
from studies.scenes.tyre.scene import ISOTROPIC

FULL = {"load_fraction": "1"}

CASES = (
    Case("scordelis-lo", ("4x4", "8x8", "16x16"), "32x32", measure="linear"),
    Case("pinched-cylinder", ("8x8", "16x16", "24x24"), "32x32", measure="linear"),
    Case("hemisphere", ("8x8", "12x12", "20x20"), "32x32", FULL),
    Case("cantilever", ("16x1", "32x1", "64x1"), "64x1", FULL),
    Case("pressurised-cylinder", ("1x2", "2x4"), "2x4"),
    Case("strip-contact", ("8x2", "16x2"), "64x1", {"load_fraction": "5"}, "linear"),
    Case("crushed-ring-solid", ("1x12", "1x24"), "1x48", {"delta_mm": "5.5625,11.125"}),
    Case(
        "tyre, isotropic",
        ("16x18", "24x26", "32x30"),
        "60x58",
        {**ISOTROPIC, "delta_mm": f"{DELTA_MM:g}"},
        scene="tyre",
    ),
    # whole bricks: those with a rule of eight points soften further where cords leave their plane
    Case(
        "tyre, angle plies, inflated",
        ("10x12", "12x14", "14x18"),
        "84x80",
        {**FOLLOWER, "delta_mm": "0"},
        scene="tyre",
        integration="full",
        held=True,
    ),
)
