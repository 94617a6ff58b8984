"""What the workflow installs as the oldest versions are the lower bounds that the project declares."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_the_oldest_versions_are_tested() -> None:
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["dependencies"]
    bounds = dict(text.split(">=") for text in declared)
    workflow = (ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8")
    job = re.split(r"^  \w+:", workflow.partition("\n  oldest:")[2], maxsplit=1, flags=re.MULTILINE)[0]
    pinned = dict(re.findall(r'"([\w-]+)==([\d.]+)\.\*"', job))
    assert pinned.keys() == bounds.keys()
    for name, bound in bounds.items():  # 14 and 14.0.* are one
        assert pinned[name].split(".")[: bound.count(".") + 1] == bound.split("."), name
