"""The page of random cases: counts of a made-up table, its findings with their commands, and planted faults."""

from __future__ import annotations

from pathlib import Path

from reports.chapters.limits.fuzz import fuzz_page
from reports.store.tables import load_store


def test_counts_explanations_findings_and_faults(store: Path) -> None:
    text = fuzz_page(load_store(store)).text
    assert "6 cases, of which 1 break a law" in text
    assert "| outcome | requests of all scenes | matrices with an answer | panels posed in two ways |" in text
    assert "| all | 4 | 1 | 1 |" in text
    assert "| converged | 3 | 1 | 1 |" in text
    assert "| part = whole | 1 | 0 | 1 | 0 | 0 |" in text
    assert "| not both are stable | 1 |" in text
    assert "| 5 | derivatives | off by 1 |" in text
    assert "footprint fuzz --seed 5" in text
    assert "2 faults were planted" in text
    assert "1 were not found, and the others by case 12 at the latest" in text
    assert "| wrong area | certified | 12 |" in text
