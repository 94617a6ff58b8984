"""``from footprint import solve, describe``: values or text, data frames, figures, one line for what is wrong."""

from __future__ import annotations

import inspect
import json
import subprocess
import sys
import typing
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest

from studies.cli import main
from studies.footprint import Run, UsageError, describe, scene, solve, sweep
from studies.scenes import SCENES


@pytest.fixture(scope="module")
def run() -> Run:
    material = {"E_MPa": 20, "nu": 0.45}
    return solve("tyre", measure="exact", mesh=(8, 10), model="full", delta_mm=[5, 10], **material)


def test_values_and_text_are_the_command_line(run: Run, tmp_path: Path) -> None:
    words = ["--mesh", "8x10", "--model", "full", "--set", "delta_mm=5,10", "--set", "E_MPa=20", "--set", "nu=0.45"]
    assert main(["solve", "tyre", *words, "--out", str(tmp_path / "line")]) == 0
    run.write(tmp_path / "python")
    line, python = (json.loads((tmp_path / name / "result.json").read_text()) for name in ("line", "python"))
    assert {key: line[key] for key in ("settings", "steps", "quantities")} == {
        key: python[key] for key in ("settings", "steps", "quantities")
    }
    text = solve("tyre", mesh="8x10", model="full", delta_mm="5,10", E_MPa="20", nu="0.45")
    pd.testing.assert_frame_equal(text.steps, run.steps)


def test_a_row_for_each_requested_load(run: Run) -> None:
    assert run.steps["delta_mm"].tolist() == [5.0, 10.0]
    assert run.steps["force_N"].is_monotonic_increasing
    assert run.outcome == "converged"
    assert run.reason
    assert run.quantities["inflated_equator_outer_mm"] > 0
    assert {"dofs", "newton_iterations", "total_s"} <= run.cost.keys()
    assert {"equilibrium", "penetration", "tension", "complementarity", "energy"} <= set(run.certificate)
    assert run.certificate["failures"].tolist() == ["", ""]


@pytest.mark.slow
def test_figures_are_those_of_plot(run: Run) -> None:
    figures = run.figures()
    assert len(figures) == 4
    assert all(figure.axes for figure in figures)


@pytest.mark.slow
def test_what_does_not_converge_is_kept() -> None:
    run = solve("tyre", mesh="12x12", delta_mm=(5, 95), settle=1)
    assert run.outcome == "limit-point"
    assert "last converged at" in run.reason
    assert run.steps["delta_mm"].tolist() == [5.0]


@pytest.mark.parametrize(
    ("scene", "asked", "says"),
    [
        ("bicycle", {}, "scene 'bicycle' must be one of"),
        ("tire", {}, r"did you mean tyre\?$"),
        ("tyre", {"delta": 3}, r"see footprint show tyre; did you mean delta_mm\?$"),
        ("tyre", {"colour": 1}, "tyre has no setting 'colour'"),
        ("tyre", {"delta_mm": [10, 5]}, "increasing numbers"),
        ("tyre", {"delta_mm": [5, None]}, "increasing numbers"),
        ("tyre", {"p0_MPa": np.nan}, "p0_MPa = nan must be a number in"),
        ("tyre", {"mesh": (12, 12.5)}, "two whole numbers"),
        ("tyre", {"mesh": 12}, "two whole numbers"),
        ("tyre", {"steps": 1.5}, "whole number"),
        ("tyre", {"steps": True}, "whole number"),
        ("tyre", {"measure": ["exact"]}, "must be one of exact"),
        (1, {}, "scene 1 must be one of"),
        (["tyre"], {}, "must be one of"),
        ("tyre", {"measure": "cubic"}, "measure 'cubic' must be one of"),
        ("tyre", {"mesh": "12x12", "contact": "regularised", "epsilon": np.inf}, "does not apply"),
    ],
)
def test_wrong_use_is_one_line(scene: Any, asked: dict[str, object], says: str) -> None:
    with pytest.raises(UsageError, match=says) as error:
        solve(scene, **asked)
    assert "\n" not in str(error.value)


def test_values_of_numpy_and_whole_numbers_are_those_of_text() -> None:
    text = solve("cantilever", mesh="4x1", steps=2, surfaces="3", mesh_error=False)
    values = solve("cantilever", mesh=np.array([4, 1]), steps=np.int64(2), surfaces=3, mesh_error=False)
    assert values.result.request == text.result.request
    assert solve("cantilever", mesh=(4.0, 1.0), steps="2", surfaces="3", mesh_error=False).steps.equals(text.steps)


@pytest.mark.parametrize(
    ("over", "says"),
    [
        ({"h_mm": 1}, r"over h_mm=\[1\] must be A:B:N"),
        (["h_mm"], r"must be settings with their values"),
        ({"h_mm": [1, 1]}, "two finite numbers that differ"),
    ],
)
def test_a_wrong_range_is_one_line(over: Any, says: str) -> None:
    with pytest.raises(UsageError, match=says):
        sweep("ring", over, mesh="1x12", delta_mm=20)


@pytest.mark.parametrize("name", ["bicycle", None, ["tyre"]])
def test_what_is_no_part_is_not_described(name: Any) -> None:
    with pytest.raises(UsageError):
        describe(name)


def test_describe_is_show() -> None:
    settings = describe("tyre").settings.set_index("name")
    assert settings.loc["delta_mm", ["unit", "default"]].tolist() == ["mm", "5,10,15,20"]


def test_the_package_is_light_and_its_names_stay_functions() -> None:
    code = (
        "import sys, studies.footprint as door; heavy = [m for m in ('numpy', 'pandas') if m in sys.modules];"
        "from studies.footprint import solve, describe; import studies.cli, studies.commands.solve;"
        "from studies.footprint import solve as again; print(heavy, solve is again, callable(door.describe))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[] True True"


@pytest.mark.slow
def test_the_error_of_the_mesh_is_stated_unless_it_is_left_out() -> None:
    run = solve("ring", mesh="1x64")
    low, high = (run.errors["P_R2_over_EI"][end] for end in ("low", "high"))
    assert low < run.quantities["P_R2_over_EI"] < high
    assert not solve("ring", mesh="1x64", mesh_error=False).errors
    with pytest.raises(UsageError, match="start = 'warm' must be one of nested, cold"):
        solve("ring", start="warm")


def table_of(html: str) -> pd.DataFrame:
    """The one table, its cells as text."""
    assert html.count("<table") == 1
    table = ElementTree.fromstring(html[html.index("<table") : html.index("</table>") + len("</table>")])
    head, *rows = [[cell.text or "" for cell in row] for row in table.iter("tr")]
    return pd.DataFrame(rows, columns=head)


def test_an_answer_shows_itself_in_a_line_and_as_a_table(run: Run) -> None:
    assert repr(run).startswith(f"<Run tyre 8x10, exact, semismooth: {run.verdict}; ")
    assert f"force_N {run.quantities['force_N']:.6g}" in repr(run)
    assert len(repr(run)) < 200
    table = table_of(run._repr_html_())
    assert table["force_N"].astype(float).to_numpy() == pytest.approx(run.steps["force_N"].to_numpy(), rel=1e-5)


def test_meanings_are_shown_whole_and_no_text_is_taken_for_markup() -> None:
    stated = describe("tyre")
    assert repr(stated) == f"<Description tyre (scene): {stated.meaning}>"
    table = table_of(stated._repr_html_())
    assert table["meaning"].tolist()[:10] == stated.settings["meaning"].tolist()[:10]
    assert "<script>" not in replace(stated, meaning="<script>alert(1)</script>")._repr_html_()


def test_a_sweep_and_a_choice_show_themselves() -> None:
    swept = sweep("panel", {"delta_mm": "0.1:0.2:2"}, mesh="4x4")
    assert repr(swept) == "<Swept panel over delta_mm (2): 2 of 2 solved>"
    table = table_of(swept._repr_html_())
    assert table["delta_mm"].astype(float).tolist() == [0.1, 0.2]


def test_scenes_are_functions_whose_settings_complete() -> None:
    assert dir(scene) == sorted(name.replace("-", "_") for name in SCENES)
    keywords = inspect.signature(scene.two_rings).parameters
    for key in ("mesh", "measure", "contact", "delta_mm", "pairing", "mu", "tolerance", "settle"):
        assert keywords[key].kind is inspect.Parameter.KEYWORD_ONLY
    assert typing.get_args(keywords["pairing"].annotation) == ("nodes", "mortar")
    assert keywords["pairing"].default == "mortar"
    assert "two rings" in (scene.two_rings.__doc__ or "").lower()
    with pytest.raises(AttributeError, match="no scene 'bicycle'"):
        scene.bicycle  # noqa: B018


def test_a_scene_as_a_function_is_solve() -> None:
    given = {"mesh": "4x1", "mesh_error": False}
    assert scene.cantilever(**given).quantities == solve("cantilever", **given).quantities
    with pytest.raises(UsageError, match="must be"):
        scene.cantilever(load_fraction="much")
