"""What the algorithms say of their parameters is true."""

from __future__ import annotations

import dataclasses

import pytest

from contact.catalogue import ALGORITHMS
from contact.parameters import EPSILON, Parameter
from studies.ask.scene import Setting
from studies.ask.settings import configured, own_keys


@pytest.mark.parametrize("name", ALGORITHMS)
def test_every_parameter_is_a_field_with_a_default_in_its_range(name: str) -> None:
    algorithm = ALGORITHMS[name]
    fields = {field.name: field.default for field in dataclasses.fields(algorithm)}
    keys = [parameter.key for parameter in algorithm.parameters]
    assert EPSILON in algorithm.parameters
    assert len(set(keys)) == len(keys)
    for parameter in algorithm.parameters:
        default = fields[parameter.key]
        assert parameter.meaning
        assert Setting.of(parameter, default).parse(str(default)) == default


@pytest.mark.parametrize("name", ALGORITHMS)
def test_the_name_in_the_catalogue_is_the_algorithm_s(name: str) -> None:
    assert ALGORITHMS[name]().name == name


def test_an_algorithm_gets_its_own_settings_alone() -> None:
    assert own_keys() == ("settle", "c", "backend", "eps", "system", "method")
    chosen = configured("lcp", {"epsilon": 7.0, "method": "nnls", "settle": 0.5, "p0_MPa": 1.0})
    assert (chosen.epsilon, chosen.method) == (7.0, "nnls")


def test_a_default_out_of_its_range_is_seen() -> None:
    """Must fail beside must pass."""
    with pytest.raises(ValueError, match="share"):
        Setting.of(Parameter("share", "of something", low=0, high=1), 2.0).parse("2.0")
