"""The strip, the sandwich plate and the cylinder of cross-plies: what is printed, elasticity, and shells."""

import itertools
import math

import numpy as np
import pytest

from contact.algorithms.semismooth import Semismooth
from formulations.section.laminate import Ply
from formulations.wall_stresses import S33, WallStresses
from studies.ask.request import UsageError
from studies.scenes.benchmarks import laminated_plates, layered_cylinders
from studies.scenes.benchmarks.laminated_plates import CORE, FACE, LINE_LOAD, PLIES, PRESSURE, SIDE, SPAN, THICKNESSES
from studies.scenes.closed_forms.elasticity import ovalised, through_wall
from studies.scenes.complete import complete
from studies.scenes.walk import walk
from support.problems.solved import extrapolated, solved

SLOW = pytest.mark.slow
VARADAN = {4.0: 4.009, 10.0: 1.223, 50.0: 0.5495, 100.0: 0.4715, 500.0: 0.1027}  # w, recalled


def limit(scene: str, meshes: tuple[str, str], **settings: str) -> dict[str, float]:
    """Of two meshes, whose order is 2."""
    coarse, fine = (solved(scene, mesh, measure="linear", **settings).quantities for mesh in meshes)
    return {name: float(extrapolated(coarse[name], fine[name])) for name in fine}


# --- closed forms -------------------------------------------------------------------------------------------------


def test_what_is_printed_of_the_strip_is_a_beam_of_layers() -> None:
    """M E h/(2 D), V S/D and P L^3/(48 D) + P L/(4 G A_s): so the recalled dimensions and the load are the printed."""
    z = np.linspace(-0.5, 0.5, 10001)
    ply = np.minimum(np.searchsorted(np.cumsum(THICKNESSES) - 0.5, 0.5 * (z[1:] + z[:-1])), len(PLIES) - 1)
    along = np.array([each.angle == 0 for each in PLIES])[ply]
    E, G, dz = np.where(along, PLIES[0].E_L, PLIES[0].E_T), np.where(along, PLIES[0].G_LT, PLIES[0].G_TT), np.diff(z)
    D = np.sum(E * np.diff(z**3)) / 3
    moment, force = LINE_LOAD * SPAN / 4, LINE_LOAD / 2
    tau = -force / D * np.append(0.0, np.cumsum(E * np.diff(z**2) / 2))  # < 0 with E z < 0 below
    shear = np.sum((0.5 * (tau[1:] + tau[:-1])) ** 2 / G * dz) / force**2
    printed = laminated_plates.OF_BEAM
    assert moment * PLIES[0].E_L / (2 * D) == pytest.approx(printed["sigma_MPa"], abs=0.05)
    assert -abs(np.interp(-0.4, z, tau)) == pytest.approx(printed["tau_MPa"], abs=0.05)
    deflection = LINE_LOAD * SPAN**3 / (48 * D) + LINE_LOAD * SPAN / 4 * shear
    assert -deflection == pytest.approx(printed["w_mm"], abs=0.005)


def test_strip_in_plane_strain_is_a_series_of_sines() -> None:
    actual = np.zeros(3)
    for n in range(1, 150, 2):
        sign, a = math.sin(n * math.pi / 2), n * math.pi / SPAN
        lowest = through_wall(PLIES, a, 0.0, (0.0, -2 * LINE_LOAD / SPAN * sign))[0]
        actual += [lowest[0, 6] * sign, lowest[2, 4] * math.cos(a * SPAN / 4), lowest[0, 2] * sign]
    known = laminated_plates.IN_PLANE_STRAIN
    assert actual == pytest.approx([known["sigma_MPa"], known["tau_MPa"], known["w_mm"]], rel=1e-4)
    assert known["tau_equilibrium_MPa"] == known["tau_MPa"]


def sandwich(terms: int, E_N: float) -> np.ndarray:
    """w in the middle; s11, s22, s12 in the middle of the lower face: the series of the uniform pressure."""
    core = Ply(*(getattr(CORE, name) for name in PLY_CONSTANTS), E_N=E_N, G_LN=CORE.G_LN)
    actual = np.zeros(4)
    for m, n in itertools.product(range(1, terms, 2), repeat=2):
        a, b = m * math.pi / SIDE, n * math.pi / SIDE
        y = through_wall((FACE, core, FACE), a, b, (0.0, -16 * PRESSURE / (math.pi**2 * m * n)))
        middle, quarter = (f(m * math.pi * s) * f(n * math.pi * s) for f, s in ((math.sin, 0.5), (math.cos, 0.25)))
        actual += [y[1, 1, 2] * middle, y[0, 1, 6] * middle, y[0, 1, 7] * middle, y[0, 1, 8] * quarter]
    return actual


PLY_CONSTANTS = ("E_L", "E_T", "G_LT", "G_TT", "nu_LT", "nu_TT", "angle", "thickness")


@pytest.mark.slow
def test_the_sandwich_is_a_double_series_of_sines_and_what_is_printed_in_the_middle_of_its_face() -> None:
    """The last terms are of 1e-5 and alternate; a core ten times as stiff across the plate changes less than 1e-5."""
    actual = sandwich(40, CORE.E_N or 0.0)
    assert actual == pytest.approx(list(laminated_plates.EXACT.values()), rel=5e-5)
    assert actual == pytest.approx(list(laminated_plates.PRINTED.values()), rel=1e-2)
    soft, stiff = (sandwich(10, factor * (CORE.E_N or 0.0)) for factor in (1.0, 10.0))
    assert stiff == pytest.approx(soft, rel=1e-5)


def test_elasticity_of_cylinders_is_what_is_printed_of_them_michells_ring_and_a_plate() -> None:
    for S, printed in VARADAN.items():
        assert f"{layered_cylinders.exact(S)['w_bar']:.4g}" == f"{printed:.4g}"
    a, b, E, nu = 9.0, 11.0, 200.0, 0.3
    ring = (Ply.isotropic(E, nu, 0.7), Ply.isotropic(E, nu, 1.3))
    pulled = through_wall(ring, 0.0, 2 / 10.0, (0.0, 1.0), 1 / 10.0)
    for (layer, place), r in {(0, 0): 9.0, (0, 2): 9.7, (1, 2): 11.0}.items():
        assert pulled[layer, place, 2] == pytest.approx(ovalised(r, a, b, E, nu), rel=1e-6)
    flat, curved = (through_wall(PLIES, 0.1, 0.2, (-1.0, 0.0), k) for k in (0.0, 1e-9))
    np.testing.assert_allclose(curved, flat, rtol=1e-5, atol=1e-6)


# --- shells -------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_strip_with_held_sides_is_that_of_elasticity() -> None:
    """Three surfaces a ply; by the law they have 1 % more shear between the plies, at any mesh."""
    actual = limit("laminated-strip", ("40x1", "80x1"), sides="held")
    known = laminated_plates.IN_PLANE_STRAIN
    assert actual["w_mm"] == pytest.approx(known["w_mm"], rel=1e-4)
    assert actual["sigma_MPa"] == pytest.approx(known["sigma_MPa"], rel=2e-3)
    assert actual["tau_equilibrium_MPa"] == pytest.approx(known["tau_MPa"], rel=1e-5)
    assert actual["tau_MPa"] == pytest.approx(known["tau_MPa"], rel=1e-2)


def test_strip_of_two_faces_is_timoshenkos_beam_without_shear_correction() -> None:
    actual = solved("laminated-strip", "80x1", measure="linear", sides="held", surfaces="2").quantities
    D = sum(
        ((z + ply.thickness) ** 3 - z**3) / 3 * reduced(ply)
        for ply, z in zip(PLIES, np.cumsum((0.0, *THICKNESSES)) - 0.5, strict=False)
    )
    GA = sum(ply.thickness * (ply.G_LT if ply.angle == 0 else ply.G_TT) for ply in PLIES)
    deflection = LINE_LOAD * SPAN**3 / (48 * D) + LINE_LOAD * SPAN / (4 * GA)
    assert -actual["w_mm"] == pytest.approx(deflection, rel=2e-3)
    assert actual["tau_equilibrium_MPa"] == pytest.approx(laminated_plates.OF_BEAM["tau_MPa"], rel=2e-3)


def reduced(ply: Ply) -> float:
    """C_11 - C_13^2/C_33 [MPa]: no stress along the normal, no strain across the strip."""
    C = ply.stiffness()
    return float(C[0, 0] - C[0, 3] ** 2 / C[3, 3])


@pytest.mark.slow
def test_strip_with_free_sides_is_what_is_printed_but_for_the_stress_under_the_load() -> None:
    """A beam does not feel the line load below it: in elasticity there is 2.4 % more, and in the shell the same.

    In the middle of a strip with free sides there is 0.5 % less than in plane strain: they carry more than their share.
    """
    free, held = (
        solved("laminated-strip", mesh, measure="linear", sides=sides).quantities
        for mesh, sides in (("40x2", "free"), ("40x1", "held"))
    )
    for name in ("w_mm", "tau_MPa", "tau_equilibrium_MPa"):
        assert free[name] == pytest.approx(laminated_plates.OF_BEAM[name], rel=1e-2)
    assert free["sigma_MPa"] == pytest.approx(held["sigma_MPa"], rel=5e-3)
    assert laminated_plates.IN_PLANE_STRAIN["sigma_MPa"] / laminated_plates.OF_BEAM["sigma_MPa"] > 1.02


@pytest.mark.parametrize("surfaces", ["2/ply", pytest.param("3/ply", marks=SLOW)])
def test_sandwich_is_that_of_elasticity_and_what_is_printed(surfaces) -> None:
    actual = limit("sandwich-plate", ("8x8", "16x16"), surfaces=surfaces)
    for name, exact in laminated_plates.EXACT.items():
        assert actual[name] == pytest.approx(exact, rel=2e-3)
        assert actual[name] == pytest.approx(laminated_plates.PRINTED[name], rel=1e-2)


def test_two_faces_are_too_stiff_for_a_sandwich() -> None:
    """Their one shear strain meets G h of the faces, 4.7 and 11.7 times that of the core."""
    actual = solved("sandwich-plate", "8x8", measure="linear", surfaces="2").quantities
    assert 0.65 < actual["w_mm"] / laminated_plates.EXACT["w_mm"] < 0.75


@pytest.mark.parametrize(
    ("S", "surfaces", "deflection", "hoop", "shear"),
    [
        pytest.param("100", "3/ply", 3e-3, 1e-3, 0.06, marks=SLOW),
        pytest.param("2", "4/ply", 4e-3, 4e-2, 2e-2, marks=SLOW),
        pytest.param("10", "4/ply", 1e-3, 1e-3, 2e-3, marks=SLOW),
        pytest.param("4", "4/ply", 1e-3, 1.2e-2, 5e-3, marks=SLOW),
    ],
)
def test_cylinder_is_that_of_elasticity(S, surfaces, deflection, hoop, shear) -> None:
    """Three surfaces a ply have 6 % too little of the small shear tau_xz by the law, and all of it by equilibrium."""
    actual = limit("laminated-cylinder", ("8x8", "16x16"), S=S, surfaces=surfaces)
    exact = layered_cylinders.exact(float(S))
    assert actual["w_bar"] == pytest.approx(exact["w_bar"], rel=deflection)
    for name in ("sigma_theta_inner_bar", "sigma_theta_outer_bar"):
        assert actual[name] == pytest.approx(exact[name], rel=hoop)
    for name in ("tau_xz_bar", "tau_thetaz_bar"):
        assert actual[name] == pytest.approx(exact[name], rel=shear)
        assert actual[f"{name}_equilibrium"] == pytest.approx(exact[name], rel=4e-3)


def test_stress_across_a_curved_wall_is_in_equilibrium_with_the_pressure_inside() -> None:
    """On a crest, where 3/ply and 16 elements leave 2 % of p0."""
    S = 4.0
    scene, request = complete("laminated-cylinder", {"S": S}, "16x16", measure="linear")
    model = scene.build(request)
    (end,) = walk(model.stages(), Semismooth())
    p0 = 10 * layered_cylinders.E_L * layered_cylinders.DEFLECTION / S**4
    stresses = WallStresses.of(model.shell, end.state.u, p0)
    R = S * layered_cylinders.H
    plies = through_wall(layered_cylinders.PLIES, math.pi / (4 * R), 4 / R, (-1.0, 0.0), 1 / R)
    crest, middle = -1, len(stresses.d) // 2
    assert stresses.equilibrium[crest, middle, 2] / p0 == pytest.approx(plies[1, 1, 3], abs=0.02)
    assert stresses.equilibrium[crest, -1, 2] / p0 == pytest.approx(0.0, abs=0.02)
    assert stresses.law[crest, middle, S33] / p0 == pytest.approx(plies[1, 1, 3], abs=0.05)


def test_a_strip_of_one_element_is_refused() -> None:
    scene, request = complete("laminated-strip", {}, "1x1")
    with pytest.raises(UsageError, match="mesh 1x1 must have at least 2 elements along the strip"):
        scene.build(request)


def test_equilibrium_through_the_wall_is_refused_where_the_wall_is_no_plate_and_no_cylinder() -> None:
    scene, request = complete("rubber-sphere", {}, "2x2")
    shell = scene.build(request).shell
    with pytest.raises(ValueError, match="that of a plate or a cylinder"):
        WallStresses.of(shell, np.zeros(shell.discretisation.n_free))
