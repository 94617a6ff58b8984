"""A plugin of pytest: parameters of tests that change nothing in what is asked to be solved.

``pytest -p support.inert_parameters ...`` ends with a list of them, one a line: the test, and the parameter whose
values, the others being the same, ask for the same requests. Some choose what is looked at; one that was meant to
choose what is solved is inert, and the test shows less than its name says. It must be loaded before the tests are.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import groupby
from typing import Any

import pytest

from studies.scenes import complete as completing

HEADING = "parameters that change no request"
_ASKED: list[str] = []
_complete = completing.complete


def _recorded(*args: Any, **options: Any) -> Any:
    scene, request = _complete(*args, **options)
    _ASKED.append(request.key())
    return scene, request


completing.complete = _recorded


@dataclass(frozen=True)
class Variant:
    """One run of a parametrised test: its parameters by name, and the requests that it asked for."""

    test: str
    parameters: Mapping[str, str]
    asked: frozenset[str]

    def without(self, name: str) -> Hashable:
        """What must agree for two variants to differ in this parameter alone."""
        return tuple(sorted((other, value) for other, value in self.parameters.items() if other != name))


@dataclass
class Recorder:
    """The variants of a session."""

    variants: list[Variant] = field(default_factory=list)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Iterator[None]:
        _ASKED.clear()
        yield
        parameters = getattr(getattr(item, "callspec", None), "params", None)
        if parameters and _ASKED:
            test = item.nodeid.partition("[")[0]
            said = {name: repr(value) for name, value in parameters.items()}
            self.variants.append(Variant(test, said, frozenset(_ASKED)))

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        terminalreporter.section(HEADING)
        for line in inert(self.variants):
            terminalreporter.line(line)


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(Recorder())


def inert(variants: Iterable[Variant]) -> list[str]:
    """``test: parameter`` where no two variants that differ in it alone ask for different requests."""
    values = []
    for test, own in groupby(sorted(variants, key=lambda each: each.test), key=lambda each: each.test):
        mine = list(own)
        for name in mine[0].parameters:
            groups: dict[Hashable, list[Variant]] = defaultdict(list)
            for each in mine:
                groups[each.without(name)].append(each)
            several = [group for group in groups.values() if len(group) > 1]
            if several and all(len({each.asked for each in group}) == 1 for group in several):
                values.append(f"{test}: {name}")
    return values
