"""The record of a case in a store: examined in a child of the pool, named by its number and its sources."""

from __future__ import annotations

from typing import Any

from studies.fuzz.examine import BROKEN, examine
from studies.result import CONVERGED, WRONG
from studies.store.atomic import SCHEMA, as_text
from studies.store.source_hash import sources_hash

NAME = "fuzz"


def task_id(seed: int, kind: str) -> str:
    """Name of a case in the store: its kind, its number and the sources that decide it."""
    return f"{NAME}-{sources_hash([examine.__module__])[:12]}-{kind}-{seed}"


def record_of(name: str) -> str:
    """Examine the case of a name; the text of its record, which has what every record of the store has."""
    _, kind, seed = name.rsplit("-", 2)
    report = examine(int(seed), kind, smaller=True)
    told = {"schema": SCHEMA, "id": name, "class": WRONG if report.verdict == BROKEN else CONVERGED}
    empty: dict[str, Any] = {"settings": {}, "quantities": {}, "steps": [], "counters": {}, "timing_s": {}, "files": []}
    return as_text({**told, **empty, "scene": report.kind, "reason": report.said, "case": report.row})
