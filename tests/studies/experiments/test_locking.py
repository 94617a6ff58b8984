"""Locking: what must not lock does not, what must lock does, by the factor the theory says."""

import math

import numpy as np
import pandas as pd
import pytest

from formulations.geometry.surfaces import cylinder, hyperboloid
from formulations.section.laminate import Laminate, Ply
from studies.experiments import locking
from studies.scenes.closed_forms.harmonic import HarmonicShell

EXACT = 1e-6  # what the element solves exactly, up to the condition of a plate of h/L = 0.01
FLAT = 0.005  # spread of found/exact over the whole range of h/R on one mesh: no locking
ROUNDING = 0.003  # of the thinnest shells: (L/h)^2 = 1e10 of the 1e16 of double precision, and the mesh takes the rest


def spread(ratios: pd.Series) -> float:
    return float(ratios.max() / ratios.min() - 1)


def richardson(values: pd.Series) -> tuple[float, float]:
    coarse, middle, fine = values
    order = math.log2((middle - coarse) / (fine - middle))
    return order, fine + (fine - middle) / (2**order - 1)


# --- Poisson thickness locking ----------------------------------------------------------------------------------


def test_thickness_locking_is_exactly_the_law_on_every_mesh_and_the_full_law_must_fail() -> None:
    """Numbers of the reference sheet: (1 - nu)^2/(1 - 2 nu), and (1 - nu)/((1 + nu)(1 - 2 nu)) equibiaxially."""
    table = locking.thickness_locking(meshes=(8, 16))
    np.testing.assert_allclose(table["stiffness_ratio"], table["law"], rtol=EXACT)
    full = table[table["section"] == "full-3d"].set_index(["load", "nu"])["stiffness_ratio"]
    for load, nu, factor in (
        ("moment", 0.3, 1.225),
        ("pressure", 0.45, 3.025),
        ("equibiaxial", 0.3, 1.346),
        ("equibiaxial", 0.45, 3.793),
    ):
        np.testing.assert_allclose(full[load, nu], factor, rtol=5e-4)
    assert set(table["section"]) == {"full-3d", "constant-s33", "nonsymmetric"}
    np.testing.assert_allclose(table[table["section"] != "full-3d"]["stiffness_ratio"], 1, rtol=EXACT)


def test_thickness_locking_does_not_fade_in_thin_shells() -> None:
    thin = [locking.thickness_locking((0.3,), (8,), ("full-3d",), h)["stiffness_ratio"].to_numpy() for h in (0.1, 1e-3)]
    np.testing.assert_allclose(thin[0], thin[1], rtol=1e-4)


# --- shear locking ----------------------------------------------------------------------------------------------


def test_straight_cantilever_has_no_shear_locking() -> None:
    """The error is 1/(4 n^2) of the bending part whatever l/h; a fully integrated element keeps nothing of it."""
    for n in (8, 16):
        table = locking.shear_locking(elements=n)
        np.testing.assert_allclose(table["ratio"], table["two_node"], rtol=2e-4)
        thin = table[table["l_over_h"] >= 10]
        assert spread(thin["ratio"]) <= 2e-4
        assert np.all(thin["fully_integrated"] < 0.025)


# --- curved beam: membrane and trapezoidal locking --------------------------------------------------------------


def test_curved_beam_does_not_lock_and_converges_to_the_closed_form() -> None:
    """Linear strain between the faces instead of 1/(1 + z/R): a difference of second order in h/R, 0.27 % at 0.1."""
    ring = locking.curved_beam()
    for _, rows in ring.groupby("elements"):
        assert spread(rows["ratio"]) <= FLAT
        assert spread(rows.query("1e-4 <= h_over_R <= 1e-2")["ratio"]) <= ROUNDING / 10
    limits = {h: richardson(ring[ring["h_over_R"] == h]["ratio"]) for h in (1e-1, 1e-2, 1e-3)}
    assert limits[1e-3] == (pytest.approx(2, abs=0.05), pytest.approx(1, abs=1e-4))
    gap = abs(limits[1e-1][1] - 1)
    assert gap == pytest.approx(0.0027, abs=2e-4)
    assert abs(limits[1e-2][1] - 1) <= 0.02 * gap


def test_face_unknowns_must_fail_in_the_thinnest_ring() -> None:
    """(L/h)^4 = 1e16 and more is beyond double precision in face displacements, and the table says so."""
    thinness = (1e-3, 1e-4, 1e-5)
    faces, director = (locking.curved_beam(thinness, (16,), unknowns)["ratio"] for unknowns in ("faces", "director"))
    assert faces[0] == pytest.approx(director[0], rel=2e-3)
    assert faces[1:].isna().all()
    assert director.notna().all()


# --- shells of revolution: the harmonic reference and membrane locking ------------------------------------------


def isotropic(h: float, nu: float = 1 / 3) -> Laminate:
    return Laminate.single(Ply.isotropic(1.0, nu, h))


def test_harmonic_reference_is_the_ring_where_it_is_one() -> None:
    """Free ends and nu = 0: p R^4/((n^2 - 1)^2 D) cos n a2 in thin shells, by shear and stretch O((n h/R)^2) more."""
    for n in (2, 3):
        for h in (1e-2, 1e-3):
            energy = HarmonicShell(cylinder(1.0), isotropic(h, 0.0), n, 1.0, 1.0, clamped=False).energy()
            ring = 0.5 * np.pi / 4 * 12 / (h**3 * (n**2 - 1) ** 2)
            assert abs(energy / ring - 1) <= (n * h) ** 2


@pytest.mark.slow
@pytest.mark.parametrize("clamped", [False, True])
@pytest.mark.parametrize("surface", [cylinder(1.0), hyperboloid(1.0, 1.0)], ids=["cylinder", "hyperboloid"])
def test_harmonic_reference_does_not_depend_on_its_degree(surface, clamped) -> None:
    for h, same in ((1e-1, 1e-10), (1e-3, 1e-5), (1e-5, 1e-4)):
        coarse, fine = (
            HarmonicShell(surface, isotropic(h), 2, 1.0, 1.0, clamped, degree).energy() for degree in (80, 120)
        )
        assert coarse == pytest.approx(fine, rel=same)


def test_energy_of_the_hyperboloid_scales_as_bending_or_as_membrane() -> None:
    """Free ends t^-3, clamped ends t^-1 (the reference sheet), in the thin limit."""
    for clamped, power in ((False, -3), (True, -1)):
        thick, thin = (
            HarmonicShell(hyperboloid(1.0, 1.0), isotropic(h), 2, 1.0, 1.0, clamped).energy() for h in (1e-4, 1e-5)
        )
        assert math.log10(thick / thin) == pytest.approx(power, abs=0.01)


@pytest.mark.slow
def test_the_cylinder_of_pitkaranta() -> None:
    """Bending it does not lock; what a reduced element gains there it does not lose where the ends are clamped. At
    t/R = 1e-2 it is better than the reduced bilinear element printed by Elmer, an order better than the unreduced.
    """
    table = locking.membrane_locking(("cylinder",), membranes=("compatible",))
    free, clamped = (table[table["end"] == end] for end in ("free", "clamped"))
    for _, rows in free.groupby("elements"):
        assert spread(rows["energy_ratio"]) <= FLAT
    order, limit = richardson(free.query("h_over_R == 1e-3")["energy_ratio"])
    assert order == pytest.approx(2, abs=0.15)
    assert limit == pytest.approx(1, abs=ROUNDING)
    errors = np.abs(clamped["energy_ratio"] - 1).groupby(clamped["elements"]).max()
    np.testing.assert_array_less(errors, [0.03, 0.01, 0.003])
    rows = free.query("h_over_R == 1e-2")
    assert np.all(rows["energy_norm_error"] < rows["yardstick_reduced"])
    assert np.all(rows["energy_norm_error"] < rows["yardstick_unreduced"] / 4)
    assert table.query("h_over_R != 1e-2")["yardstick_reduced"].isna().all()


@pytest.mark.slow
def test_bending_hyperboloid_locks_by_the_third_order_on_coarse_meshes() -> None:
    """U/U_h - 1, less what is there in the thick shell, grows by 100 per decade of h and falls by 64 per halving."""
    table = locking.membrane_locking(("hyperboloid",), ("free",), (1e-3, 1e-4, 1e-5), membranes=("compatible",))
    excess = (1 / table.pivot_table(index="elements", columns="h_over_R", values="energy_ratio") - 1).sub(
        1 / table.query("h_over_R == 1e-3").set_index("elements")["energy_ratio"] - 1, axis=0
    )
    assert excess.loc[8, 1e-5] / excess.loc[8, 1e-4] == pytest.approx(100, rel=0.1)
    assert excess.loc[8, 1e-5] / excess.loc[16, 1e-5] == pytest.approx(64, rel=0.15)
    assert excess.loc[16, 1e-5] / excess.loc[32, 1e-5] == pytest.approx(64, rel=0.15)
    assert table.query("h_over_R == 1e-5 and elements == 8")["energy_ratio"].item() < 0.05  # must fail


def test_relaxed_membrane_helps_the_clamped_hyperboloid_and_not_the_free_one() -> None:
    table = locking.membrane_locking(("hyperboloid",), thinness=(1e-4,), meshes=(16,))
    error = np.abs(table["energy_ratio"] - 1).set_axis(pd.MultiIndex.from_frame(table[["end", "membrane"]]))
    assert error["clamped", "relaxed"] < 0.2 * error["clamped", "compatible"]
    assert error["free", "relaxed"] > 0.8 * error["free", "compatible"]
