"""A campaign in which neither measure, algorithm, iteration nor element varies has all its pages, too."""

from __future__ import annotations

from pathlib import Path

import pytest

from studies.cli import main


@pytest.mark.slow
def test_a_campaign_of_one_configuration_is_analysed_and_reported(tmp_path: Path) -> None:
    campaign, store = tmp_path / "t.toml", str(tmp_path / "store")
    campaign.write_text('title = "t"\n[[cross]]\nname = "t"\n[cross.scenes.panel]\nmeshes = ["2x2"]\n')
    assert main(["run", str(campaign), "--store", store]) == 0
    assert main(["analyse", "t", "--store", store]) == 0
    assert main(["report", "--store", store, "--out", str(tmp_path / "pages")]) == 0
    assert "# Appendix" in (tmp_path / "pages" / "data.md").read_text(encoding="utf-8")
