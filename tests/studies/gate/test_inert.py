"""Every setting of every scene has an effect, or its reason to have none is known; planted ones are found."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from contact.catalogue import ALGORITHMS
from studies.ask.request import Request
from studies.ask.scene import SceneModel, Setting, UsageError
from studies.scenes import SCENES
from studies.scenes.benchmarks.cantilever import Cantilever
from studies.scenes.benchmarks.quads import OnQuads
from studies.scenes.complete import complete
from support.inert_settings import FAILS, NONE, REFUSED, algorithm_effects, effects, inert_settings

PLANE = ("morley-skew-plate", "slender-beam")
# the membrane is relaxed by curvature and warp, and these have none
FLAT = (
    "cantilever",
    "sze-annulus",
    "sze-moment",
    "pagano",
    "strip-contact",
    "heavy-strip",
    "plate-contact",
    "walled-column",
    "face-patch",
    "inflated-membrane",
    "laminated-strip",
    "sandwich-plate",
    *PLANE,
)
CORRECTED = {"strip-contact", "heavy-strip", "plate-contact"}  # for shear, which two faces alone are
FIRST = {type(SCENES[name]): name for name in sorted(SCENES, reverse=True)}
QUICK = ("cantilever", "free-hyperboloid", "ring", "roof-a", "pressurised-cylinder")


def found(*names: str) -> set[tuple[str, str]]:
    rows = inert_settings(names)
    assert not rows["effect"].str.startswith(FAILS).any(), rows
    return set(zip(rows["scene"], rows["setting"], strict=True))


@pytest.mark.slow
def test_settings_of_some_scenes_all_have_an_effect() -> None:
    assert found(*QUICK) == {("cantilever", "membrane")}


@pytest.mark.slow
def test_settings_of_the_others_have_an_effect_or_belong_to_curved_ones() -> None:
    """One scene of each class: settings are those of the class."""
    others = {name for kind, name in FIRST.items() if kind not in {type(SCENES[quick]) for quick in QUICK}}
    on_quads = {name: scene for name in others if isinstance(scene := SCENES[name], OnQuads)}
    refused = {(name, "interpolation") for name, scene in on_quads.items() if not scene.lines_of_curvature}
    refused |= {(name, key) for name in CORRECTED & others for key in ("surfaces", "law")}
    blown = ("inflated-membrane", "rubber-sphere")  # 3 and 3/ply are one; not svk
    refused |= {(name, key) for name in blown for key in ("surfaces", "law")}
    assert found(*sorted(others)) == refused | {(name, "membrane") for name in FLAT if name in others}


@dataclass(frozen=True)
class Planted(Cantilever):
    """With a friction that nobody reads, and a thickness that somebody does."""

    name: str = "planted"
    settings: tuple[Setting, ...] = (
        *Cantilever.settings,
        Setting("mu", 0.0, "friction", low=0, high=1),
        Setting.one_of("side", ("left", "right"), "left", "where it is hit"),
        Setting.positive("seen", 1.0, "what it is multiplied by when it is read"),
    )

    def build(self, request: Request) -> SceneModel:
        model = super().build(request)
        scale = request.number("seen")
        read = model.measure_at
        object.__setattr__(model, "measure_at", lambda *at: {key: scale * x for key, x in read(*at).items()})
        return model


def test_planted_inputs_that_nobody_reads_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(SCENES, "planted", Planted())
    by_setting = effects("planted").set_index("setting")["effect"]
    assert by_setting["mu"] == by_setting["side"] == NONE
    assert by_setting["seen"].startswith("observed")
    assert by_setting["load_fraction"].startswith("path")
    assert found("planted") == {("planted", "membrane"), ("planted", "mu"), ("planted", "side")}


@pytest.mark.slow
def test_what_another_choice_wakes_up_is_asleep_before() -> None:
    before = effects("panel").set_index("setting")["effect"]
    assert before["gamma_deg"] == before["ball_mm"] == NONE
    assert effects("panel", {"foundation": "ball"}).set_index("setting")["effect"]["ball_mm"].startswith("problem")
    assert effects("panel", {"E_ratio": 10.0}).set_index("setting")["effect"]["gamma_deg"].startswith("problem")


def test_a_solid_refuses_what_it_would_ignore() -> None:
    for key, value in (("path", "arc"), ("arc_points", 10), ("rim", "pressure")):
        with pytest.raises(UsageError, match=f"tyre-solid has no setting '{key}'"):
            complete("tyre-solid", {key: value})


@pytest.mark.slow
def test_an_adapted_mesh_follows_the_travel_also_where_the_path_is_an_arc() -> None:
    settings = {"path": "arc", "grading": "adapted", "delta_mm": 10.0}
    scene, request = complete("tyre", settings, (12, 10))
    by_travel = complete("tyre", {**settings, "path": "travel"}, (12, 10))[1]
    assert scene.lines(request)[0] == pytest.approx(scene.lines(by_travel)[0])


@pytest.mark.slow
def test_parameters_of_algorithms_without_effect_are_known() -> None:
    """A pressed node has no gap and an open one no pressure, so semismooth's c decides nothing.

    qp ends exactly, and so does every method of lcp: their eps and method change what is spent and not what is found.
    """
    rows = algorithm_effects()
    assert set(rows["contact"]) == set(ALGORITHMS)

    def only(*effects: str) -> set[tuple[str, str]]:
        idle = rows["effect"].str.startswith((*effects, REFUSED)).groupby([rows["contact"], rows["setting"]]).all()
        return {key for key, none in idle.items() if none}

    assert only(NONE) == {("semismooth", "c")}
    assert only(NONE, "work") >= {("semismooth", "c"), ("qp", "eps"), ("lcp", "method")}
