"""Rotations one after another: nothing is left where the measure is exact, and their order may not be exchanged."""

import math
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import Rotation

from formulations.strains.catalogue import MEASURES
from studies.experiments import rotations
from studies.experiments.rotations import ANGLE, ASTRAY, BACK, Panel, cases, rotations_table, turned
from studies.experiments.specimens import Element

NOTHING = 1e-9  # Newton's iteration ends at forces of 1e-11 of those of strain 1
EXACT = ("exact", "elongation")


def test_rotations_are_those_of_scipy_and_may_not_be_exchanged() -> None:
    """About axes fixed in space, in the order Z, Y, X: lower case there."""
    angles = [ANGLE] * 3
    np.testing.assert_allclose(turned(BACK, 3), Rotation.from_euler("zyx", angles).as_matrix(), atol=1e-15)
    np.testing.assert_allclose(turned(BACK, 6), np.eye(3), atol=1e-15)
    other = Rotation.from_euler("xyz", angles).as_matrix()
    added = Rotation.from_rotvec(angles).as_matrix()
    for wrong in (other, added, turned(ASTRAY, 6) @ turned(BACK, 3)):
        assert np.abs(wrong - turned(BACK, 3)).max() > 0.1


@pytest.mark.slow
def test_every_measure_comes_back_and_only_exact_ones_kept_their_energy_on_the_way() -> None:
    """In another order, the commutator of three rotations, the panel is elsewhere and as strained as before."""
    table = rotations_table()
    assert set(table["measure"]) == set(MEASURES)
    assert len(table.groupby(["measure", "interpolation"])) == len(cases())
    exact = table[(table["measure"] == "exact") & (table["interpolation"] == "isoparametric")]
    assert (exact["outcome"] == "converged").all()
    assert exact["off"].max() < NOTHING
    for (body, path), own in exact.groupby(["body", "path"]):
        assert len(own) == 7
        assert own["away"].iloc[1:6].min() > 0.4  # it has moved by half of its length
        assert path == "back" or own["away"].iloc[-1] > 0.4
        assert own["strain"].max() < NOTHING if body == "free" else own["strain"].min() > 0.05
    back = table[(table["path"] == "back") & (table["leg"] == 6)]
    assert len(back) == 2 * len(cases())
    assert back["off"].max() < NOTHING
    assert back["energy_change"].abs().max() < NOTHING
    there = table[(table["leg"] == 3) & (table["body"] == "strained") & (table["path"] == "back")]
    changes = there.set_index(["measure", "interpolation"])["energy_change"]
    for (measure, interpolation), change in changes.items():
        kept = measure in EXACT and interpolation == "isoparametric"
        assert abs(change) < NOTHING if kept else abs(change) > 0.01
    assert exact["energy_change"].abs().max() < NOTHING
    positions = changes.xs("isoparametric", level="interpolation")
    assert positions["linear"] > positions["von-karman"] > positions["sanders"] > positions["novozhilov"] > 1


@pytest.mark.slow
def test_what_interpolated_components_leave_falls_with_the_second_order(monkeypatch: pytest.MonkeyPatch) -> None:
    """About the axis Z the frame turns with the shell, and nothing is left; about Y and X it does not."""
    element, off = Element("curvilinear", "balanced"), []
    for n in (4, 8, 16):
        monkeypatch.setattr(rotations, "ELEMENTS", n)
        found = pd.DataFrame(Panel(MEASURES["exact"], element, False, BACK[:3]).run())
        assert found["strain"][1] < NOTHING
        off.append(found["off"][3])
    orders = [math.log2(coarse / fine) for coarse, fine in pairwise(off)]
    np.testing.assert_allclose(orders, 2, atol=0.2)


@pytest.mark.slow
def test_large_steps_must_fail_by_another_equilibrium() -> None:
    """Four steps a rotation: on its way back the panel folds at its edges and keeps the fold, five times the energy."""
    element = Element("curvilinear", "balanced")
    panel = Panel(MEASURES["exact"], element, True, BACK)
    few, more = (pd.DataFrame(panel.run(steps)) for steps in (4, rotations.STEPS))
    assert few["energy_change"].iloc[-1] > 1
    assert few["off"].iloc[-1] > 0.1
    assert more["off"].iloc[-1] < NOTHING
