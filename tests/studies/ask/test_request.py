"""The request as a record: hashable, typed where it is read, the same for every spelling, and whole through JSON."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest

from studies.ask.request import Request, Settings, text_of
from studies.ask.scene import has_contact
from studies.output.atomic import plain
from studies.scenes import SCENES
from studies.scenes.complete import complete


@pytest.mark.parametrize("scene", SCENES)
def test_a_request_is_hashable_and_survives_the_index(scene: str) -> None:
    request = complete(scene, {})[1]
    again = Request.of(json.loads(json.dumps(plain(request.data))))
    assert again == request
    assert again.key() == request.key()
    assert len({again, request, replace(request, mesh=(3, 3))}) == 2


def test_contact_is_a_property_of_the_scene() -> None:
    touching = {name for name, scene in SCENES.items() if has_contact(scene)}
    rings = {"ring", "crushed-ring", "crushed-ring-solid"}
    pieces = {"panel", "plate-contact", "strip-contact", "heavy-strip", "manufactured-contact"}
    assert {"tyre", "tyre-solid", *rings, *pieces} == touching
    for name in SCENES:
        assert ("epsilon" in complete(name, {})[1].settings) == (name in touching)


def test_keys_differ_in_what_is_asked_and_in_nothing_else() -> None:
    request = complete("tyre", {"delta_mm": "5,10"})[1]
    other = replace(request, mesh=(4, 2), settings=request.settings.with_values(epsilon=1e4))
    assert request.key() != other.key()
    assert request.key(("mesh",)) != other.key(("mesh",))
    assert request.key(("mesh", "epsilon")) == other.key(("mesh", "epsilon"))
    assert request.key() == replace(request, model_reason="for people").key()
    turned = Settings(dict(reversed(list(request.settings.items()))))
    assert request.key() == replace(request, settings=turned).key()
    whole = Request("tyre", settings=Settings({"plies": 4}))
    assert whole.key() == Request("tyre", settings=Settings({"plies": 4.0})).key()


def test_values_have_a_type_where_they_are_read() -> None:
    request = complete("tyre", {"delta_mm": "5,10", "epsilon": "inf"})[1]
    assert request.number("plies") == 4.0
    assert math.isinf(request.number("epsilon"))
    assert request.numbers("delta_mm") == (5.0, 10.0)
    assert request.choice("load") == "dead"
    for read, key in ((request.number, "load"), (request.numbers, "plies"), (request.choice, "delta_mm")):
        with pytest.raises(TypeError, match=f"{key} = "):
            read(key)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.001, "0.001"),
        (1e-9, "1e-09"),
        (510.451234, "510.451234"),
        (4, "4"),
        (4.0, "4"),
        (math.inf, "inf"),
        ((0.5, 1.0), "0.5,1"),
        ("dead", "dead"),
    ],
)
def test_texts_read_back(value: object, text: str) -> None:
    assert text_of(value) == text
