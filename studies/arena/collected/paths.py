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


Wanted = tuple[str, dict[str, str]]  # a scene and settings


def _of(scene: str, *unusual: dict[str, str], **shared: str) -> tuple[Wanted, ...]:
    return tuple((scene, {**settings, **shared}) for settings in unusual)


LINES = (
    *_of("strip-contact", {"lam_over_a": "0.1"}, {"lam_over_a": "0.01"}),
    *_of("heavy-strip", {"lam_over_unit": "0.2"}, {"lam_over_unit": "0.02"}),
    ("plate-contact", {}),
)
RINGS = (
    *_of("ring", {"h_mm": "1"}, {"h_mm": "0.1"}, {"h_mm": "10"}, delta_mm="1,35,50"),
    *_of("crushed-ring", {}, {"nu": "0.499"}),
)
PANELS = _of(  # under a plane or a ball: everything that makes a step difficult, each alone
    "panel",
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
TYRES: tuple[dict[str, str], ...] = (  # definite with the paper's element, indefinite, follower loads, sections, ...
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
# what is looked along: meshes, each with all scenes and settings, and how many iterates
LOOKED: tuple[tuple[tuple[str, ...], tuple[Wanted, ...], int], ...] = (
    (("4x1", "16x1", "64x1"), LINES, 0),
    (("256x1",), LINES, 3),
    (("64x1",), (*_of("plate-contact", {"hole": "0.2"}), *_of("strip-contact", {"load_fraction": "1,100"})), 0),
    (("1x8", "1x16", "1x64", "1x256"), RINGS, 3),
    (("2x2", "6x6", "14x14"), PANELS, 0),
    (("8x8", "16x16"), _of("manufactured-contact", {}), 3),
    (("6x6", "12x12"), _of("tyre", *TYRES, delta_mm="0.5,5,15,20"), 3),
    (("20x20", "28x26"), _of("tyre", *TYRES[:5], delta_mm="5,20"), 2),
    (
        ("1x12", "1x24"),
        _of("crushed-ring-solid", {"law": "svk"}, {"law": "neo-hooke"}, per_ply="2", delta_mm="5,20"),
        3,
    ),
    (("6x8",), _of("tyre-solid", {}, delta_mm="5,20"), 3),
    (("12x16",), _of("tyre-solid", {}, delta_mm="10"), 2),
    # what takes most of the size, last: all else has its place by then
    (("42x40",), _of("tyre", {}, delta_mm="20"), 2),
    (("42x40",), _of("tyre", {"delta_mm": "20", "element": "paper"}), 1),
    (("44x44",), _of("panel", {}, {"shape": "plate"}, {"foundation": "ball"}, delta_mm="3"), 1),
)


def paths() -> Iterator[Path]:
    """All of them, in their order."""
    for meshes, wanted, looks in LOOKED:
        for mesh, (scene, settings) in product(meshes, wanted):
            yield Path(scene, mesh, settings, looks)
