"""The pages of limits: causes, ticks and looks of maps, curves that are shared, and parts of a measured force."""

from __future__ import annotations

import inspect
import math

import numpy as np
import pandas as pd
import pytest

from reports.chapters.extremes import LOOKS, cause, plain_ticks
from reports.chapters.invariance import shared_curves
from reports.chapters.shell_limits import PARTS, errors, ring_part
from reports.figures.drawing import drawn
from reports.files import SCHEMA
from reports.store import Store
from studies.analysis import uncertainty
from studies.experiments.extremes import CLASSES
from studies.experiments.shell_limits.bodies import DEFAULT
from studies.output import atomic
from support.stores.experiments import made_up_walls


def test_what_reports_and_studies_both_hold_is_one() -> None:
    """As reports import nothing of ours."""
    assert uncertainty.PARTS == PARTS
    assert atomic.SCHEMA == SCHEMA
    assert set(LOOKS) == set(CLASSES)


def test_causes_are_counted_without_their_numbers() -> None:
    reason = "a state beyond the path, 2 more eigenvalues; the load step was cut; bifurcation near 0.4: 13 % of that"
    assert cause(reason) == "a state beyond the path, the tangent shows a bifurcation"
    assert cause("the judge finds tension beyond its bounds") == "the judge finds tension beyond its bounds"
    assert cause("cut; too few converged steps to tell why") == "cut, too few steps converged to tell why"
    assert cause("limit point of the path at 2.93: it turns back") == "the tangent shows a limit point"


def test_every_class_has_a_look_of_its_own() -> None:
    colours = {colour for colour, _ in LOOKS.values()}
    assert len(colours) == len(set(LOOKS.values())) == len(LOOKS)


TOWARDS_A_LIMIT = 10.0 ** np.linspace(-1, -4, 17)
VALUES = {
    "near a half": np.round(0.5 - TOWARDS_A_LIMIT, 6),
    "near one": np.round(1 - 10 * TOWARDS_A_LIMIT, 6),
    "powers": 10.0 ** np.linspace(-6, -1, 17),
    "even": np.linspace(-0.05, 0.35, 17),
}


@pytest.mark.parametrize("values", VALUES.values(), ids=VALUES)
def test_ticks_are_several_and_different(values: np.ndarray) -> None:
    places, labels = plain_ticks(values)
    assert 3 <= len(places) == len(labels) <= 9
    assert len(set(labels)) == len(labels)
    assert places == sorted(places)
    numbers = [float(label) for label in labels if "$" not in label]
    assert all(values.min() * (1 - 1e-9) <= number <= values.max() for number in numbers if number > 0)


def test_measures_with_the_same_strain_share_a_curve() -> None:
    strains = {"a": math.sin, "b": math.cos, "c": math.sin}
    rows = [(name, angle, strain(angle)) for name, strain in strains.items() for angle in (0.1, 1)]
    table = pd.DataFrame(rows, columns=["measure", "theta_rad", "strain"])
    assert [names for names, _ in shared_curves(table)] == ["a, c", "b"]


def test_parts_are_stacked_from_zero(loaded: Store) -> None:
    with drawn() as figures:
        ring_part(loaded).pictures["experiment.svg"]()
    (figure,) = figures
    bars = figure.axes[1].patches
    assert sum(bar.get_height() for bar in bars if bar.get_x() > 2.5) == pytest.approx(-0.09 * 32.033 + 100 / 64**2)


def test_the_picture_of_limits_has_a_line_a_scene_and_both_levels() -> None:
    points = made_up_walls()
    usual = points[points["variant"] == DEFAULT].drop_duplicates("case")
    (axes,) = inspect.unwrap(errors)(points, usual).axes
    bad, better, best, *levels = axes.get_lines()
    assert [line.get_label() for line in (bad, better, best)] == ["bad", "better", "best"]
    assert bad.get_ydata() == pytest.approx([1e-4, 9e-4, 1e-2, 0.25])
    assert len(best.get_ydata()) == 0  # nothing that is told from zero
    assert [float(line.get_ydata()[0]) for line in levels] == [0.01, 0.05]
