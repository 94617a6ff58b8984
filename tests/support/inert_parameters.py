"""A plugin of pytest: parameters of tests that change nothing in what is asked to be solved.

``pytest -p support.inert_parameters ...`` ends with a list of them, one a line: the test, and the parameter whose
values, the others being the same, ask for the same requests. Some choose what is looked at; one that was meant to
choose what is solved is inert, and the test shows less than its name says. It must be loaded before the tests are.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
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

    @classmethod
    def of(cls, item: pytest.Item, asked: Iterable[str] = ()) -> Variant:
        """Without parameters where the test has none."""
        parameters = getattr(getattr(item, "callspec", None), "params", {})
        said = {name: repr(value) for name, value in parameters.items()}
        return cls(item.nodeid.partition("[")[0], said, frozenset(asked))


@dataclass
class Recorder:
    """The variants of a session; of a test no more are run than show that each of its parameters has a say."""

    variants: dict[str, list[Variant]] = field(default_factory=lambda: defaultdict(list))
    open: dict[str, set[str]] = field(default_factory=dict)  # parameters that may be inert

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, config: pytest.Config, items: list[pytest.Item]) -> None:
        planned = defaultdict(list)
        for item in items:
            planned[Variant.of(item).test].append(Variant.of(item))
        self.open = {test: {name for name, _ in alike(own)} for test, own in planned.items()}
        config.hook.pytest_deselected(items=[item for item in items if not self.open[Variant.of(item).test]])
        items[:] = [item for item in items if self.open[Variant.of(item).test]]

    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        if not self.open[Variant.of(item).test]:
            pytest.skip("its parameters have a say")

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Iterator[None]:
        _ASKED.clear()
        yield
        if _ASKED:
            variant = Variant.of(item, _ASKED)
            own = self.variants[variant.test]
            own.append(variant)
            self.open[variant.test] -= {name for name, asked in alike(own) if len(asked) > 1}

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        terminalreporter.section(HEADING)
        for test in sorted(self.variants):
            for name in inert(self.variants[test]):
                terminalreporter.line(f"{test}: {name}")


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(Recorder())


def alike(variants: Sequence[Variant]) -> Iterator[tuple[str, set[frozenset[str]]]]:
    """A parameter and what was asked for by variants of a test that differ in it alone, wherever there are several."""
    for name in variants[0].parameters:
        groups: dict[Hashable, list[Variant]] = defaultdict(list)
        for each in variants:
            groups[each.without(name)].append(each)
        yield from ((name, {each.asked for each in group}) for group in groups.values() if len(group) > 1)


def inert(variants: Sequence[Variant]) -> list[str]:
    """Parameters of a test where no two variants that differ in one alone ask for different requests."""
    several = {name for name, _ in alike(variants)}
    return sorted(several - {name for name, asked in alike(variants) if len(asked) > 1})
