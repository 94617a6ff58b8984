"""Ladders: scenes on three or more meshes, what is read off them, and the cells that climb them.

The same ladders serve every element and every table over all scenes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from studies.campaigns.cell import Cell

LABEL = "convergence {ladder} {mesh} {element}"


@dataclass(frozen=True)
class Ladder:
    """A scene on meshes from coarse to fine; the size of their elements falls as 1 over the first number.

    quantities: what is judged, the first one is the scene's headline. at: the step where they are read, KEY=VALUE;
    without one, the last step. family: whose picture they are in. settings, measure: as for ``footprint solve``.
    coarser: what is solved in the place of the finest mesh where that is left out and only two would be left.
    causes: why quantities by name are not in an asymptotic range.
    """

    name: str
    scene: str
    family: str
    meshes: tuple[str, ...]
    quantities: tuple[str, ...]
    settings: Mapping[str, str]
    measure: str
    at: str
    coarser: tuple[str, ...] = ()
    causes: Mapping[str, str] = field(default_factory=dict)

    def climbed(self, *, finest: bool) -> tuple[str, ...]:
        """Its meshes, with the finest or without."""
        return self.meshes if finest else (*self.coarser, *self.meshes[:-1])


def _ladder(
    scene: str,
    family: str,
    meshes: tuple[str, ...],
    quantities: tuple[str, ...],
    *,
    name: str = "",
    measure: str = "exact",
    at: str = "",
    **settings: str,
) -> Ladder:
    """A ladder with the name of its scene unless another is given."""
    return Ladder(name or scene, scene, family, meshes, quantities, settings, measure, at)


def _from_second(ladder: Ladder) -> Ladder:
    """The same without its first mesh, which is too coarse for an order."""
    return replace(ladder, meshes=ladder.meshes[1:], coarser=ladder.meshes[:1])


def _meshes(n1: int, n2: int, factors: tuple[int, ...] = (1, 2, 4, 8)) -> tuple[str, ...]:
    """Multiples of a mesh; by default each halves the elements of the one before."""
    return tuple(f"{n1 * k}x{n2 * k}" for k in factors)


def _linear(scene: str, *quantities: str, **settings: str) -> Ladder:
    return _ladder(scene, "linear shells", _meshes(8, 8), quantities, measure="linear", **settings)


_ROTATIONS, _SNAP, _CLOSED, _CONTACT, _TYRE = "large rotations", "snap through", "closed forms", "contact", "tyre"
_TYRE_MESHES = _meshes(14, 18)  # those of the solid, and one more
ISOTROPIC = {
    **{"E_MPa": "20", "nu": "0.45", "plies": "1", "ply_thickness_mm": "4.8"},
    **{"load": "follower", "pressure_area": "face"},
}
_SQUEEZE = (
    "the rim carries a line force, which passes from one ring of nodes to the next as soon as the elements are as small"
    " as the strip of 0.6 thicknesses over which it squeezes the wall"
)
_CANCEL = "two errors of different order and opposite sign cancel on these meshes"
_JUMPS = (
    "the rim of the patch, an oval that no grid line follows, passes from line to line, and that changes the value as"
    " much as the size of the elements still does"
)
_COARSE = "coarse elements lock in the folds, and that error falls faster than the second order that is left in the end"
_STRIPS = ("16x1", "32x1", "64x1", "128x1")  # nothing varies across
_LONG = ("64x1", "128x1", "256x1", "512x1")
_PLATES = ("14x1", "28x1", "56x1", "112x1")
_FULL = {"load_fraction": "1"}
# A free edge has a layer as wide as the wall is thick, where twist turns into shear: even lines meet it on one mesh of
# many, and the order changes there.
_EDGES = {**_FULL, "lines": "edges"}
_RIM = {"lines": "rim"}
_TIP = ("tip_deflection_mm", "tip_shortening_mm")
_WALL = ("stretch", "thickness_ratio")
_PATCH = ("force_N", "centre_pressure_MPa")
_LOADED = ("inward_mm", "outward_mm")
_DISC = ("contact_force", "contact_radius")
_LIMIT = ("limit_load_fraction", "limit_w_C_even_mm")
_RESULTANTS = tuple(f"N_{name}_{place}_N_per_mm" for place in ("crown", "inner") for name in ("phi", "theta"))


def _roof(letter: str, n: int) -> Ladder:
    return _from_second(_ladder(f"roof-{letter}", _SNAP, _meshes(n, n), _LIMIT, lines="edges", until="limit"))


LADDERS = (
    # nothing varies across, nu = 0; coarser, two errors of different order take turns
    _ladder("cantilever", _ROTATIONS, _LONG, _TIP, **_FULL),
    _ladder("sze-moment", _ROTATIONS, _meshes(32, 1), _TIP, load_fraction="0.5"),
    _from_second(_ladder("sze-annulus", _ROTATIONS, _meshes(5, 40), ("w_B_mm", "w_A_mm"), **_EDGES)),
    *(  # two families with one limit: components or positions interpolated
        _from_second(_ladder("hemisphere", _ROTATIONS, _meshes(16, 16), _LOADED, name=name, **_EDGES, **family))
        for name, family in (
            ("hemisphere", {}),
            ("hemisphere-isoparametric", {"interpolation": "isoparametric"}),
        )
    ),
    replace(  # even lines: with closer ones at the load the path is lost at its snap
        _from_second(_ladder("sze-pullout", _ROTATIONS, _meshes(6, 9), ("w_A_even_mm", "u_B_mm", "u_C_mm"), **_FULL)),
        causes={"u_C_mm": _CANCEL},
    ),
    _from_second(  # before the snap
        _ladder("sze-pinched", _ROTATIONS, _meshes(8, 8), ("w_A_mm", "u_B_mm"), load_fraction="0.1")
    ),
    *(
        replace(
            _from_second(_ladder(f"semicylinder{plies}", _ROTATIONS, _meshes(6, 6), ("w_A_mm",))),
            causes={"w_A_mm": _COARSE},
        )
        for plies in ("", "-0-90-0", "-90-0-90")
    ),
    _roof("a", 8),  # 8x8 is still too coarse
    *(_roof(letter, 4) for letter in "bcde"),
    replace(_roof("f", 4), causes={_LIMIT[0]: _CANCEL}),
    _ladder(  # nothing varies around the axis
        "shallow-cap", _SNAP, ("8x2", "16x2", "32x2", "64x2"), ("limit_load_fraction", "limit_w_apex_mm")
    ),
    _linear("scordelis-lo", "edge_deflection_mm"),
    _linear("pinched-cylinder", "deflection_mm", shear_correction="1000"),
    # 8x8 locks in the thin one
    *(
        _from_second(_linear("free-hyperboloid", "w_waist_mm", name=f"free-hyperboloid-{t}", t_over_R=t))
        for t in ("0.1", "0.001")
    ),
    *(_linear("pagano", "w_bar", "sigma_x_bar", name=f"pagano-S{S}", S=f"{S}") for S in (10, 100)),
    *(
        _ladder(
            "pressurised-cylinder", _CLOSED, _meshes(2, 4), _WALL, name=f"pressurised-cylinder-{e}", **_FULL, ends=e
        )
        for e in ("fixed", "open")
    ),
    _ladder("pressurised-sphere", _CLOSED, _meshes(2, 2), _WALL, **_FULL),
    # one element around the axis: nothing varies there
    _ladder("pressurised-torus", _CLOSED, _LONG, _RESULTANTS),
    *(
        _ladder("strip-contact", _CONTACT, _STRIPS, quantities, name=name, measure="linear", load_fraction="5", **shear)
        for name, quantities, shear in (
            # lam so large that the elements resolve the pressure at the rim before they resolve the wall's squeeze
            ("strip-contact", ("half_force", "free_length", "edge_pressure"), {"lam_over_a": "0.2", **_RIM}),
            ("strip-contact-no-shear", ("half_force",), {"lam_over_a": "0.001"}),
        )
    ),
    _ladder("heavy-strip", _CONTACT, _LONG, ("lift_force", "free_length"), measure="linear", **_FULL, **_RIM),
    replace(
        _ladder("plate-contact", _CONTACT, _PLATES, _DISC, measure="linear", load_fraction="5", **_RIM),
        causes={"contact_radius": _SQUEEZE},
    ),
    _from_second(
        _ladder("ring", _CONTACT, _meshes(1, 10), ("P_H2_over_EI", "flat_half_length"), delta_mm="50", **_RIM)
    ),
    replace(_ladder("tyre", _TYRE, _TYRE_MESHES, _PATCH, delta_mm="20"), causes=dict.fromkeys(_PATCH, _JUMPS)),
    replace(
        _ladder("tyre", _TYRE, _TYRE_MESHES, _PATCH, name="tyre-isotropic", at="delta_mm=10", **ISOTROPIC),
        causes=dict.fromkeys(_PATCH, _JUMPS),
    ),
)

BENCHMARKS = (  # with the element of the paper, at every load of the published tables
    _ladder("cantilever", "benchmarks", ("16x1", "32x2", "64x4"), ("tip_shortening_mm", _TIP[0])),
    _ladder("hemisphere", "benchmarks", _meshes(16, 16, (1, 2, 4)), ("outward_mm", "inward_mm")),
)


def cells(element_settings: Mapping[str, str], element_label: str, *, finest: bool = True) -> tuple[Cell, ...]:
    """The cells of all ladders with one element; their labels are those that the pages ask for.

    ``finest``: with the last mesh of each ladder, which costs more than all others together.
    """
    return tuple(
        Cell(
            LABEL.format(ladder=ladder.name, mesh=mesh, element=element_label),
            ladder.scene,
            {"measure": ladder.measure, "mesh": mesh},
            {**ladder.settings, **element_settings},
        )
        for ladder in LADDERS
        for mesh in ladder.climbed(finest=finest)
    )
