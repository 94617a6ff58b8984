"""Constants that studies and reports both hold, as reports import nothing of ours: they are one."""

from __future__ import annotations

import pytest

from reports import reading
from reports.chapters import shell_limits
from studies.analysis import uncertainty
from studies.output import atomic


@pytest.mark.parametrize(
    ("here", "there"),
    [(shell_limits.PARTS, uncertainty.PARTS), (reading.SCHEMA, atomic.SCHEMA)],
    ids=["parts of the budget", "schema of records"],
)
def test_a_constant_on_both_sides_is_one(here: object, there: object) -> None:
    assert here == there
