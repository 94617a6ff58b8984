"""Which paths the collection looks along: every scene with contact, small before large, plain before unusual.

Only requests are listed here, with what each is looked at for; which iterates are taken is a rule (collection).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import product


@dataclass(frozen=True)
class Path:
    """A request; looks: how many iterates of a solve are looked at, its first ones and its last, 0 for all."""

    scene: str
    mesh: str
    settings: Mapping[str, str] = field(default_factory=dict)
    looks: int = 0

    @property
    def name(self) -> str:
        """The request as one word."""
        told = [f"{key}={value}".replace(",", "_") for key, value in self.settings.items()]
        return "-".join([self.scene, self.mesh, *told])


def paths() -> Iterator[Path]:
    """All of them."""
    yield from _lines()
    yield from _panels()
    yield from _tyres()
    yield from _solids()
    yield from _large()


def _lines() -> Iterator[Path]:
    """Strips, plates and rings: a row of candidates."""
    for mesh in ("4x1", "16x1", "64x1", "256x1"):
        looks = 3 if mesh == "256x1" else 0
        for thin in ("0.1", "0.01"):
            yield Path("strip-contact", mesh, {"lam_over_a": thin}, looks)
        for thin in ("0.2", "0.02"):
            yield Path("heavy-strip", mesh, {"lam_over_unit": thin}, looks)
        yield Path("plate-contact", mesh, {}, looks)
    yield Path("plate-contact", "64x1", {"hole": "0.2"})
    yield Path("strip-contact", "64x1", {"load_fraction": "1,100"})
    for mesh in ("1x8", "1x16", "1x64", "1x256"):
        for thickness in ("1", "0.1", "10"):
            yield Path("ring", mesh, {"h_mm": thickness, "delta_mm": "1,35,50"}, looks=3)
        yield Path("crushed-ring", mesh, {}, looks=3)
        yield Path("crushed-ring", mesh, {"nu": "0.499"}, looks=3)


def _panels() -> Iterator[Path]:
    """Panels under a plane or a ball: two rows of everything that makes a step difficult, each alone."""
    unusual: tuple[dict[str, str], ...] = (
        {},
        {"foundation": "ball"},
        {"foundation": "ball", "ball_mm": "1"},
        {"h_over_R": "0.001"},
        {"h_over_R": "0.0001"},
        {"h_over_R": "0.2"},
        {"aspect": "100"},
        {"irregular": "0.9"},
        {"E_ratio": "1000"},
        {"nu": "0.4999"},
        {"inflation": "1", "load": "follower"},
        {"inflation": "-0.3", "load": "follower"},
        {"inflation": "0.3"},
        {"shape": "sphere"},
        {"shape": "plate"},
        {"shape": "plate", "foundation": "ball"},
        {"delta_mm": "0"},
        {"delta_mm": "0.001"},
        {"delta_mm": "10"},
    )
    for mesh, settings in product(("2x2", "6x6", "14x14"), unusual):
        yield Path("panel", mesh, settings)
    for mesh in ("8x8", "16x16"):
        yield Path("manufactured-contact", mesh, {}, looks=3)


def _tyres() -> Iterator[Path]:
    """Shells of a tyre: definite with the paper's element, indefinite, follower loads, sections, couplings, bodies."""
    unusual: tuple[dict[str, str], ...] = (
        {"element": "paper"},
        {},
        {"load": "follower"},
        {"section": "nonsymmetric"},
        {"coupling": "consistent"},
        {"foundation": "drum"},
        {"foundation": "hollow-drum"},
        {"foundation": "sphere"},
        {"foundation": "cleat"},
        {"gamma_deg": "0"},
        {"E_MPa": "20", "nu": "0.45", "load": "follower"},
        {"p0_MPa": "0"},
        {"p0_MPa": "0.6"},
    )
    for mesh, settings in product(("6x6", "12x12"), unusual):
        yield Path("tyre", mesh, {**settings, "delta_mm": "0.5,5,15,20"}, looks=3)
    for mesh, settings in product(("20x20", "28x26"), unusual[:5]):
        yield Path("tyre", mesh, {**settings, "delta_mm": "5,20"}, looks=2)


def _solids() -> Iterator[Path]:
    """Hexahedra: the ring between plates, and a tyre."""
    for mesh, law in product(("1x12", "1x24"), ("svk", "neo-hooke")):
        yield Path("crushed-ring-solid", mesh, {"law": law, "per_ply": "2", "delta_mm": "5,20"}, looks=3)
    yield Path("tyre-solid", "6x8", {"delta_mm": "5,20"}, looks=3)
    yield Path("tyre-solid", "12x16", {"delta_mm": "10"}, looks=2)


def _large() -> Iterator[Path]:
    """What takes most of the size, last: all else has its place by then."""
    yield Path("tyre", "42x40", {"delta_mm": "20"}, looks=2)
    yield Path("tyre", "42x40", {"delta_mm": "20", "element": "paper"}, looks=1)
    plain: tuple[dict[str, str], ...] = ({}, {"shape": "plate"}, {"foundation": "ball"})
    for settings in plain:
        yield Path("panel", "44x44", {**settings, "delta_mm": "3"}, looks=1)
