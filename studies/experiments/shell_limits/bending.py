"""Walls that bend, linear: a curved bar, a ring made oval, a cantilever, a roof, a cross-ply plate.

Bending puts shear into the wall, and strains that are hyperbolic in a curved one: there the shell's displacement,
linear through the thickness, is stiffer than the body.
"""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from formulations.conditions.boundary import Supports
from formulations.discretisation import Discretisation
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Plate, Surface, cylinder
from formulations.section.laminate import Laminate, Ply
from formulations.strains.catalogue import LINEAR
from studies.experiments.shell_limits.bodies import (
    Answer,
    Solid,
    Variant,
    body_of,
    end_forces,
    solved_shell,
    usual_shell,
)
from studies.scenes.benchmarks import pagano
from studies.scenes.benchmarks.obstacle_course import ScordelisLo
from studies.scenes.closed_forms.elasticity import golovin_turn, middle_deflection, ovalised
from studies.scenes.element import ShearCorrected, spaced_lines
from studies.scenes.statics import area_load, edge_shares

E, NU, R = 1000.0, 0.3, 100.0  # MPa, -, mm
QUARTER = np.pi / 2
STRIP = np.array([0.0, 1.0])  # the lines of a strip of width 1 [mm]
INWARDS, EDGEWISE = 2, 1


def wall(h: float, nu: float, variant: Variant) -> Laminate:
    """One isotropic layer about its middle."""
    return corrected((Ply.isotropic(E, nu, h),), variant)


def corrected(plies: Sequence[Ply], variant: Variant) -> Laminate:
    """Plies about their middle with the shear correction of a variant."""
    return ShearCorrected(tuple(plies), -sum(ply.thickness for ply in plies) / 2, variant.shear_correction)


def layered(h: float, n: int, nu: float, *, to_inner: bool = False) -> Laminate:
    """A homogeneous wall about its middle as n plies, thinner towards the outer face: lines of the solid through it."""
    levels = spaced_lines(0.0, h, n, to_inner, True)
    return Laminate(tuple(Ply.isotropic(E, nu, float(t)) for t in np.diff(levels)), -h / 2)


def shell_of(
    surface: Surface,
    grid: Grid,
    laminate: Laminate,
    supports: Supports,
    variant: Variant,
    forces: Callable[[Discretisation], np.ndarray],
) -> tuple[np.ndarray, Discretisation]:
    """Unknowns (n,) under ``forces``, (N, 6) or flat, in the local frames."""
    body = body_of(surface, grid, laminate, supports, variant)
    return solved_shell(usual_shell(body, LINEAR, variant.section, forces=forces(body))), body


def bar_shell(ratio: float, n: int, variant: Variant) -> Answer:
    """Quarter of a ring in plane strain, one end symmetric, a moment on the other."""
    h = ratio * R
    grid = Grid.tensor(STRIP, np.linspace(0.0, QUARTER, n + 1))
    start = grid.on_line(1, 0.0)
    supports = Supports.of_edges(grid, "symmetric", "symmetric", "symmetric", "free")
    supports = supports.hold(start, (INWARDS,), ("inner",))  # against moving as a whole

    def moment(body: Discretisation) -> np.ndarray:
        return end_forces(body, *edge_shares(body, 1, QUARTER), EDGEWISE, lambda d: 12 * d / h**3)

    u, body = shell_of(cylinder(R), grid, wall(h, NU, variant), supports, variant, moment)
    turn = float(moment(body) @ body.map.everywhere(u))  # on which the moment of 1 does its work
    return Answer({"rotation": turn * _bending(h) / QUARTER}, body.n_free)


def bar_solid(ratio: float, n: int) -> Answer:
    """The same with an end that stays plane, as Golovin's sections do: it moves and turns as a whole."""
    h = ratio * R
    body = Solid.over(cylinder(R), STRIP, np.linspace(0.0, QUARTER, n + 1), wall(h, NU, Variant()), max(1, n // 16))
    mesh = body.mesh
    tip, start = mesh.on(1, QUARTER), mesh.on(1, 0.0)
    body = body.hold(0).hold(EDGEWISE, start).hold(EDGEWISE, tip)
    body = body.hold(INWARDS, start[np.argmin(np.abs(mesh.parameter[start, 2]))])
    shift, turn = np.zeros((2, *mesh.x.shape))
    shift[tip, EDGEWISE], turn[tip, EDGEWISE] = 1.0, mesh.parameter[tip, 2] / h
    # the couple of M = 1: work 1 on a unit rotation, none on the shift
    nodes = tip[[np.argmin(mesh.parameter[tip, 2]), np.argmax(mesh.parameter[tip, 2])]]
    along = body.frame(mesh.parameter[nodes])[:, EDGEWISE]
    forces = np.zeros_like(mesh.x)
    forces[nodes] = np.array([[-1.0], [1.0]]) / h * along
    u, unknowns = body.solve(forces, tied=(shift, turn))
    faces = u[nodes, EDGEWISE]
    return Answer({"rotation": float(faces[1] - faces[0]) / h * _bending(h) / QUARTER}, unknowns)


def bar_exact(ratio: float) -> dict[str, float]:
    """Golovin's."""
    h = ratio * R
    return {"rotation": golovin_turn(R - h / 2, R + h / 2, E, NU) * _bending(h)}


def _bending(h: float) -> float:
    """Stiffness E h^3/(12 (1 - nu^2)) over R [N]: a thin bar turns by 1 of its inverse per moment and angle."""
    return E * h**3 / (12 * (1 - NU**2)) / R


def oval_shell(ratio: float, n: int, variant: Variant) -> Answer:
    """Quarter of a ring in plane strain under the pressure cos 2 theta pulling on its outer face."""
    h = ratio * R
    grid = Grid.tensor(STRIP, np.linspace(0.0, QUARTER, n + 1))
    supports = Supports.of_edges(grid, *("symmetric",) * 4)
    size = 1 + ratio / 2 if variant.area == "face" else 1.0

    def pull(body: Discretisation) -> np.ndarray:
        def density(a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
            return size * np.cos(2 * a2)[..., None] * np.stack([np.cos(a2), np.sin(a2), 0 * a2], axis=-1)

        return area_load(body, density, shares=(0.0, 1.0))

    u, body = shell_of(cylinder(R), grid, wall(h, NU, variant), supports, variant, pull)
    v = body.expand(u)
    return Answer({"growth": float(v[grid.node_at(0.0, 0.0), 4:].mean()) * _oval_unit(h)}, body.n_free)


def oval_solid(ratio: float, n: int) -> Answer:
    """The same."""
    h = ratio * R
    body = Solid.over(cylinder(R), STRIP, np.linspace(0.0, QUARTER, n + 1), wall(h, NU, Variant()), max(1, n // 16))
    mesh = body.mesh
    body = body.hold(0).hold(EDGEWISE, mesh.on(1, 0.0)).hold(EDGEWISE, mesh.on(1, QUARTER))
    forces = body.traction(mesh.outer, lambda x, at: np.cos(2 * at[..., 1:2]) * body.frame(at)[..., 2, :])
    u, unknowns = body.solve(forces)
    faces = u[body.line(0.0, 0.0)[[0, -1]], INWARDS]
    return Answer({"growth": float(faces.mean()) * _oval_unit(h)}, unknowns)


def oval_exact(ratio: float) -> dict[str, float]:
    """Michell's."""
    h = ratio * R
    a, b = R - h / 2, R + h / 2
    return {"growth": float(np.mean([ovalised(r, a, b, E, NU) for r in (a, b)])) * _oval_unit(h)}


def _oval_unit(h: float) -> float:
    """9 D/R^4 [MPa/mm]: a thin inextensible ring grows by 1/9 R^4/D per traction, plus what its hoop force adds."""
    return 9 * E * h**3 / (12 * (1 - NU**2)) / R**4


SPAN = 100.0  # mm


def beam_shell(ratio: float, n: int, variant: Variant) -> Answer:
    """Clamped strip in plane strain, a transverse force on its end."""
    h = ratio * SPAN
    grid = Grid.tensor(spaced_lines(0.0, SPAN, n, True), STRIP)
    supports = Supports.of_edges(grid, "clamped", "free", "symmetric", "symmetric")

    def shear(body: Discretisation) -> np.ndarray:
        return end_forces(body, *edge_shares(body, 0, SPAN), INWARDS, lambda d: 1.5 / h * (1 - (2 * d / h) ** 2))

    u, body = shell_of(Plate(), grid, wall(h, NU, variant), supports, variant, shear)
    return Answer({"deflection": float(shear(body) @ body.map.everywhere(u)) * _beam_unit(h)}, body.n_free)


def beam_solid(ratio: float, n: int) -> Answer:
    """The same under the parabola of shear on its end; the deflection is that on which it does its work."""
    h = ratio * SPAN
    lines = spaced_lines(0.0, SPAN, n, True)
    body = Solid.over(Plate(), lines, STRIP, layered(h, max(2, n // 4), NU, to_inner=True)).hold(1)
    for component in range(3):
        body = body.hold(component, body.mesh.on(0, 0.0))

    def parabola(x: np.ndarray, at: np.ndarray) -> np.ndarray:
        return 1.5 / h * (1 - (2 * at[..., 2:] / h) ** 2) * np.array([0.0, 0.0, 1.0])

    forces = body.traction(body.end(0), parabola)
    u, unknowns = body.solve(forces)
    return Answer({"deflection": float(np.sum(forces * u)) * _beam_unit(h)}, unknowns)


def _beam_unit(h: float) -> float:
    """3 D/L^3 [N/mm]: a thin strip sinks by 1 of its inverse per force and width."""
    return 3 * E * h**3 / (12 * (1 - NU**2)) / SPAN**3


ROOF, EDGE, DIAPHRAGM = ScordelisLo.RADIUS, ScordelisLo.HALF_ANGLE, ScordelisLo.LENGTH / 2  # ends of a quarter
ROOF_NU = 0.0  # as there
DOWN = np.array([-1.0, 0.0, 0.0])


def roof_shell(ratio: float, n: int, variant: Variant) -> Answer:
    """A quarter of Scordelis and Lo's roof of any thickness, on the scene's own supports.

    The weight of the volume is on the middle surface, half of it on either face.
    """
    h = ratio * ROOF
    grid = Grid.tensor(*_roof_lines(n))
    supports = Supports.of_edges(grid, "hard-diaphragm", "symmetric", "symmetric", "free")
    weigh = partial(area_load, density=lambda a1, a2: _roof_weight(h) * h * DOWN)
    u, body = shell_of(cylinder(ROOF), grid, wall(h, ROOF_NU, variant), supports, variant, weigh)
    v = body.expand(u)
    edge = grid.node_at(DIAPHRAGM, EDGE)
    frame = body.surface.frame(*grid.nodes[edge])
    return Answer({"edge deflection": float(DOWN @ (v[edge].reshape(3, 2).mean(axis=1) @ frame))}, body.n_free)


def roof_solid(ratio: float, n: int) -> Answer:
    """The same; the diaphragm holds all that lies in its plane."""
    h = ratio * ROOF
    body = Solid.over(cylinder(ROOF), *_roof_lines(n), wall(h, ROOF_NU, Variant()), max(1, n // 8))
    mesh = body.mesh
    body = body.hold(1, mesh.on(0, 0.0)).hold(2, mesh.on(0, 0.0))
    body = body.hold(0, mesh.on(0, DIAPHRAGM)).hold(1, mesh.on(1, 0.0))
    u, unknowns = body.solve(body.body_force(lambda x, at: np.broadcast_to(_roof_weight(h) * DOWN, x.shape)))
    edge = body.line(DIAPHRAGM, EDGE)[[0, -1]]
    at_edge = np.einsum("ni,nix->x", u[edge], body.frame(mesh.parameter[edge])) / 2
    return Answer({"edge deflection": float(DOWN @ at_edge)}, unknowns)


def _roof_lines(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Closer towards the diaphragm and the free edge."""
    return spaced_lines(0.0, DIAPHRAGM, n, True), spaced_lines(0.0, EDGE, n, False, True)


def _roof_weight(h: float) -> float:
    """Per volume, such that it deflects by the order of 1."""
    return h**2 / ScordelisLo.H**3


def _plies() -> tuple[Ply, ...]:
    constants = (pagano.E_L, pagano.E_T, pagano.G_LT, pagano.G_TT, pagano.NU, pagano.NU)
    return tuple(Ply(*constants, angle, pagano.H / len(pagano.ANGLES)) for angle in pagano.ANGLES)


def _bumps(x: np.ndarray, y: np.ndarray, a: float) -> np.ndarray:
    """The sinusoidal pressure (..., 3) along z of amplitude 1."""
    return (np.sin(np.pi * x / a) * np.sin(np.pi * y / (3 * a)))[..., None] * np.array([0.0, 0.0, 1.0])


def _plate_unit(a: float) -> float:
    """100 E_T h^3/a^4: Pagano's w_bar."""
    return 100 * pagano.E_T * pagano.H**3 / a**4


def plate_shell(ratio: float, n: int, variant: Variant) -> Answer:
    """A quarter of Pagano's plate, a1 and a2 in [0, a/2] and [0, 3 a/2]."""
    a = pagano.H / ratio
    grid = Grid.tensor(np.linspace(0.0, a / 2, n + 1), np.linspace(0.0, 1.5 * a, n + 1))
    supports = Supports.of_edges(grid, "hard-diaphragm", "symmetric", "hard-diaphragm", "symmetric")
    load = partial(area_load, density=lambda x, y: _bumps(x, y, a), shares=(0.0, 1.0))
    u, body = shell_of(Plate(), grid, corrected(_plies(), variant), supports, variant, load)
    w = body.at_distance(u, 0.0)[grid.node_at(a / 2, 1.5 * a), 2]
    return Answer({"w_bar": float(w) * _plate_unit(a)}, body.n_free)


def plate_solid(ratio: float, n: int) -> Answer:
    """The same, n/4 elements through each ply."""
    a = pagano.H / ratio
    lines = np.linspace(0.0, a / 2, n + 1), np.linspace(0.0, 1.5 * a, n + 1)
    body = Solid.over(Plate(), *lines, corrected(_plies(), Variant()), max(1, n // 4))
    mesh = body.mesh
    for axis, end in ((0, a / 2), (1, 1.5 * a)):
        edge = mesh.on(axis, 0.0)
        body = body.hold(1 - axis, edge).hold(2, edge).hold(axis, mesh.on(axis, end))
    u, unknowns = body.solve(body.traction(mesh.outer, lambda x, at: _bumps(x[..., 0], x[..., 1], a)))
    through = body.line(a / 2, 1.5 * a)
    return Answer({"w_bar": float(u[through[len(through) // 2], 2]) * _plate_unit(a)}, unknowns)


def plate_exact(ratio: float) -> dict[str, float]:
    """Pagano's, at any span."""
    a = pagano.H / ratio
    return {"w_bar": middle_deflection(_plies(), a, 3 * a, 1.0) * _plate_unit(a)}
