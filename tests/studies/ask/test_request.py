"""The request as a record: hashable, typed where it is read, the same for every spelling, and whole through JSON."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest

from studies.ask.request import Request, Settings, UsageError, text_of
from studies.ask.settings import Setting
from studies.output.atomic import plain
from studies.scenes import SCENES
from studies.scenes.complete import complete


def test_a_request_is_hashable_and_survives_the_index() -> None:
    for scene in SCENES:
        request = complete(scene, {})[1]
        again = Request.of(json.loads(json.dumps(plain(request.data))))
        assert again == request
        assert again.key() == request.key()
        assert len({again, request, replace(request, mesh=(3, 3))}) == 2


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


def test_texts_read_back() -> None:
    values = (0.001, 1e-9, 510.451234, 4, 4.0, math.inf, (0.5, 1.0), "dead")
    assert [text_of(each) for each in values] == ["0.001", "1e-09", "510.451234", "4", "4", "inf", "0.5,1", "dead"]


def test_lists_grow_and_hold_numbers_alone() -> None:
    for kind, wrong in (("floats", "1,1"), ("floats", "2,1"), ("floats", [True, 2.0]), ("float", True)):
        with pytest.raises(UsageError, match="must be"):
            Setting("key", None, "", kind).parse(wrong)


def test_a_kind_of_setting_that_is_none_is_refused_where_it_is_written() -> None:
    with pytest.raises(
        ValueError, match="setting 'delta_mm': kind 'numbers' must be one of float, int, choice, floats"
    ):
        Setting("delta_mm", (1.0,), "travels", "numbers")


def test_leaves_are_asked_for() -> None:
    request = complete("tyre", {})[1]
    assert request.key() != replace(request, leaves=((1, 0, 0),)).key()
