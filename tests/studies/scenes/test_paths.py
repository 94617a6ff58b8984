"""Curves of scenes by power series, by arc length, and who decides."""

from pathlib import Path

import pytest

import studies.footprint
from contact.continuation.arc_length import ArcLength
from contact.continuation.series_path import PowerSeries
from studies.ask.scene import CurveStage
from studies.cli import main
from studies.scenes import SCENES
from studies.scenes.complete import complete as resolve
from studies.solving.result import Result
from studies.solving.solve import solve

CURVES = (*(f"roof-{letter}" for letter in "abcdef"), "shallow-cap", "sze-pullout")
FACTORISATIONS = 40  # of the whole curve; arc length takes 126 to 316
LIMIT_LOAD = 1e-8  # relative
STATE = 1e-7  # relative, of what is read off at a requested load


def continuation(**asked) -> object:
    scene, request = resolve("roof-a", asked.pop("given", {}), "2x2", **asked)
    (stage,) = scene.build(request).stages()
    assert isinstance(stage, CurveStage)
    return stage.continuation


def test_series_are_taken_where_they_apply() -> None:
    assert isinstance(continuation(), PowerSeries)
    assert isinstance(continuation(measure="sanders"), PowerSeries)
    assert isinstance(continuation(measure="elongation"), ArcLength)
    assert isinstance(continuation(given={"path": "arc-length"}), ArcLength)


def test_what_does_not_apply_is_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    asked = ["solve", "roof-a", "--mesh", "2x2", "--measure", "elongation", "--set", "path=series", "--out", str(out)]
    assert main(asked) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "path = series" in line
    assert "elongation" in line
    assert "arc-length" in line
    assert not out.exists()


def test_a_notebook_reads_the_curve_where_the_load_passes() -> None:
    run = studies.footprint.solve("roof-a", mesh="4x4", load_fraction=[0.25, 1.0])
    at, step = run.at(0.25), run.result.loads[0].seen
    assert at == pytest.approx(step, rel=1e-9)
    assert run.at(0.25, passage=1)["w_C_mm"] > at["w_C_mm"]
    assert run.result.at(0.25).u.shape == (run.result.model.n_unknowns,)
    with pytest.raises(LookupError):
        run.at(1.5)
    with pytest.raises(LookupError, match="points alone"):
        studies.footprint.solve("roof-a", mesh="2x2", path="arc-length", load_fraction=0.25).at(0.25)
    with pytest.raises(LookupError, match="load steps"):
        studies.footprint.solve("cantilever", mesh="4x1").at(0.25)


@pytest.mark.parametrize("path", ["series", pytest.param("arc-length", marks=pytest.mark.slow)])
def test_the_picture_is_drawn_from_the_curve(path: str, tmp_path: Path) -> None:
    run = studies.footprint.solve("roof-a", mesh="2x2", path=path)
    drawn = run.figures()[0].axes[0].lines[0].get_xydata()
    assert drawn[0].tolist() == [0.0, 0.0]  # rest, which is no row
    assert drawn[1:, 1].tolist() == pytest.approx(run.result.table("curve").columns["load_fraction"])


def both(scene: str, mesh: str | None) -> list[Result]:
    return [solve(*resolve(scene, {"path": path}, mesh)) for path in ("series", "arc-length")]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "mesh"), [("roof-d", "4x4"), *(pytest.param(name, None, marks=pytest.mark.slow) for name in CURVES)]
)
def test_series_find_what_arc_length_finds(scene: str, mesh: str | None) -> None:
    """Limit loads, what is read off at requested loads, and whether one can stand there."""
    series, arc = both(scene, mesh)
    assert series.verdict == arc.verdict == "converged"
    key = "load_fraction"
    limits = [[s.load[key] for s in each.loads if s.counters["limit_point"]] for each in (series, arc)]
    assert len(limits[0]) >= 2
    assert limits[0] == pytest.approx(limits[1], rel=LIMIT_LOAD)
    for asked in series.request.numbers(key):
        ours, theirs = (next(s for s in each.loads if abs(s.load[key] - asked) < 1e-12) for each in (series, arc))
        assert ours.quantities == pytest.approx(theirs.quantities, rel=STATE)
        assert ours.certificate["stability"]["word"] == theirs.certificate["stability"]["word"]
    assert series.counters["factorisations"] <= FACTORISATIONS
    assert series.counters["factorisations"] <= 0.2 * arc.counters["factorisations"]


def test_all_curves_are_among_those_compared() -> None:
    traced = set()
    for name in SCENES:
        if any(setting.key == "path" and "series" in setting.choices for setting in SCENES[name].settings):
            traced.add(name)
    assert traced == {*CURVES}
