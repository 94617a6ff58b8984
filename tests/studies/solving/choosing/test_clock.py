"""A budget of wall time: shares, what is kept aside, a machine that others use, and solves that take too long."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from studies.scenes.complete import complete
from studies.solving.choosing.trials import Clock, until
from studies.solving.solve import Interrupted, solve


def planted(wall: float = 0.0, work: float = 0.0) -> tuple[Clock, SimpleNamespace]:
    time = SimpleNamespace(wall=wall, work=work)
    return Clock(60.0, lambda: time.wall, lambda: time.work), time


def test_shares_are_parts_of_what_is_left() -> None:
    clock, time = planted()
    with clock.share(0.5):
        assert clock.left == 30
        time.wall = time.work = 20.0
        assert clock.left == 10
        assert clock.fits(10.0)
        assert not clock.fits(10.1)
    assert clock.left == 40
    with clock.share(0.5, 20.0):
        assert clock.left == 10
    with clock.share(0.5, 100.0):
        assert clock.left == 0
        assert not clock.fits(0.1)


def test_what_is_foreseen_takes_longer_on_a_machine_that_others_use() -> None:
    clock, time = planted()
    time.wall, time.work = 20.0, 10.0
    assert clock.wait == 2
    assert clock.fits(20.0)
    assert not clock.fits(20.1)
    time.work = 40.0  # by several threads: no reason to foresee less
    assert clock.wait == 1


def test_what_takes_too_long_is_stopped_and_an_interruption_is_none() -> None:
    asked = complete("ring", {"delta_mm": "35,40"}, "1x8")
    assert until(60.0, lambda check: solve(*asked, check)) is not None
    assert until(0.0, lambda check: solve(*asked, check)) is None

    def interrupted(text: str) -> None:
        raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        until(60.0, lambda check: solve(*asked, interrupted))
