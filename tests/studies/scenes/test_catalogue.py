"""The catalogue of scenes: names without loading anything, and every declaration in its scene's own module."""

import importlib

import pytest

from studies.ask.scene import UsageError, has_contact, judged_of, ladders_of
from studies.cli import main
from studies.run.lists import BENCHMARKS, LADDERS
from studies.scenes import MODULES, SCENES
from studies.scenes.benchmarks.quads import OnQuads
from studies.scenes.complete import complete
from studies.scenes.element import PRESETS


def test_a_module_offers_the_scenes_that_the_catalogue_names() -> None:
    for module in dict.fromkeys(MODULES.values()):
        offered = [scene.name for scene in importlib.import_module(module).SCENES]
        assert offered == [name for name, where in MODULES.items() if where == module]
        assert all(SCENES[name].name == name and type(SCENES[name]).__module__ == module for name in offered)


def test_all_ladders_that_scenes_declare_are_climbed() -> None:
    declared = [ladder for name in MODULES for ladder in ladders_of(SCENES[name])]
    climbed = (*LADDERS, *BENCHMARKS)
    assert len(climbed) == len(declared)
    assert all(ladder in climbed for ladder in declared)


def test_a_default_as_it_is_printed_asks_for_the_same_problem() -> None:
    for name, scene in SCENES.items():
        for setting in scene.settings:
            if setting.default is not None:
                assert setting.parse(setting.default_text) == setting.parse(setting.default), (name, setting.key)


def test_a_scene_says_what_it_is_judged_by() -> None:
    anywhere = ("force_N", "limit_load_fraction")
    for name, scene in SCENES.items():
        declared: dict[str, str] = getattr(scene, "quantities", {})
        for quantity in judged_of(scene):
            assert quantity in anywhere or quantity.removeprefix("limit_") in declared, (name, quantity)


def test_presets_stand_for_their_options_and_give_way_to_single_ones() -> None:
    """In every scene but solids, which have no shell's element, and those that have no lines of curvature."""
    shells = [name for name, scene in SCENES.items() if "element" in {setting.key for setting in scene.settings}]
    assert set(SCENES) - set(shells) <= {"tyre-solid", "crushed-ring-solid", "two-cylinders", "ironing"}
    shells = [name for name in shells if not isinstance(SCENES[name], OnQuads)]
    for scene in shells:
        for name, options in PRESETS.items():
            settings = complete(scene, {"element": name})[1].settings
            assert {key: settings[key] for key in options} == options
            assert "element" not in settings  # the options decide the result, not their name
        mixed = complete(scene, {"element": "paper", "thickness_strain": "balanced"})[1].settings
        assert mixed["thickness_strain"] == "balanced"
        assert mixed["membrane"] == PRESETS["paper"]["membrane"]
        assert complete(scene, {})[1] == complete(scene, {"element": "refined"})[1]


def test_unknown_options_are_refused_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "tyre", "--set", "element=best", "--out", "nowhere"]) == 2
    assert "element = 'best' must be one of paper, refined" in capsys.readouterr().err
    scene, request = complete("hemisphere", {"interpolation": "isoparametric"}, measure="donnell")
    with pytest.raises(UsageError, match="needs a measure with full gradients: one of exact"):
        scene.build(request)


def test_contact_is_a_property_of_the_scene() -> None:
    touching = {name for name, scene in SCENES.items() if has_contact(scene)}
    rings = {"ring", "crushed-ring", "crushed-ring-solid", "roller", "collapsing-tube"}
    strips = {"plate-contact", "strip-contact", "heavy-strip", "walled-column"}
    pieces = {"panel", "pressed-panel", "manufactured-contact", *strips}
    shells = {"two-rings", "pinched-ring", "stack", "half-spheres", "face-patch", "crossed-tubes"}
    pairs = {*shells, "two-cylinders", "ring-on-layer", "tyre-on-plate", "tyre-on-drum", "ironing"}
    assert {"tyre", "tyre-solid", *rings, *pieces, *pairs} == touching
    for name in SCENES:
        assert ("epsilon" in complete(name, {})[1].settings) == (name in touching)
