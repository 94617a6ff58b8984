"""Where short waves on the pressed tyre stop costing energy: the same travel on every grid and with both elements."""

import numpy as np
import pytest

from contact.algorithms.semismooth import Semismooth
from studies.scenes.complete import complete
from studies.scenes.tyre.model import beside_the_patch
from studies.scenes.walk import walk

ISOTROPIC = {"E_MPa": "20", "nu": "0.45", "plies": "1", "ply_thickness_mm": "4.8"}


def stiffness(travels: str, mesh: str, **settings: str) -> np.ndarray:
    """Least stiffness of short waves [N/mm] at each travel."""
    scene, request = complete("tyre", {"delta_mm": travels, **settings}, mesh, model="half")
    model = scene.build(request)
    pressed = [visited.state for visited in walk(model.stages(), Semismooth()) if visited.stage.name == "press"]
    seen = [beside_the_patch(model.shell, model.part, state.u, model.nodes[state.active]) for state in pressed]
    assert all(30 < each["short_wave_psi_deg"] < 100 for each in seen)
    return np.array([each["short_wave_N_mm"] for each in seen])


def test_the_wall_of_cords_loses_what_an_isotropic_wall_keeps() -> None:
    cords = stiffness("5,20", "14x14")
    assert cords[0] > 0 > cords[1]
    assert np.all(stiffness("20,40", "14x14", **ISOTROPIC) > 3.0)


@pytest.mark.slow
def test_the_travel_of_the_loss_belongs_to_the_tyre() -> None:
    """Between 13.5 and 15 mm on every grid, where limit points move from 38 to 33 mm; the element plays no part."""
    onsets = []
    for mesh, element in (("28x26", {}), ("42x40", {}), ("42x40", {"element": "paper"})):
        before, after = stiffness("13.5,15", mesh, **element)
        assert before > 0 > after
        onsets.append(13.5 + 1.5 * before / (before - after))
    assert onsets[1] == pytest.approx(onsets[0], abs=0.5)
    assert onsets[2] == pytest.approx(onsets[1], abs=0.02)
