"""Derivatives of the tyre at work: what rounding is worth, and an optimum that answers without any confirm."""

import pandas as pd
import pytest

from reports.chapters.what_if import what_if_page
from studies.experiments import what_if


def test_half_a_unit_of_the_last_digit() -> None:
    assert [what_if.half_a_unit(each) for each in ("52", "0.15", "510.45")] == pytest.approx([0.5, 0.005, 0.005])


@pytest.mark.slow
def test_no_combination_is_better_than_the_optimum(monkeypatch, tmp_path) -> None:
    """On a coarse mesh: derivatives against 25 answers that know of none; the page says which it was."""
    monkeypatch.setattr(what_if, "MESHES", ("12x14", "14x16"))
    monkeypatch.setattr(what_if, "COUNT", 5)
    monkeypatch.setattr(what_if, "BOTH", ("12x14", "14x16"))
    tables = {name: getattr(what_if, name)() for name in ("what_if", "even_footprint", "every_footprint")}
    asked, every = tables["even_footprint"], tables["every_footprint"]
    own = asked[asked["mesh"] == "12x14"]
    (optimum,) = own[own["optimum"]].to_dict("records")
    allowed = every[every["verdict"] == "converged"]
    for name, least in what_if.LEAST.items():
        allowed = allowed[allowed[name] >= least]
        assert optimum[name] >= least - 1e-6 * abs(least)
    assert 0 < len(allowed) < len(every)
    assert optimum[what_if.GOAL] <= allowed[what_if.GOAL].min()
    for name, table in tables.items():
        table.to_csv(tmp_path / f"{name}.csv", index=False)

    class Stored:
        def table(self, name: str) -> pd.DataFrame:
            return pd.read_csv(tmp_path / f"{name}.csv")

    said = str(what_if_page(Stored()))
    assert f"Of 25 combinations on 12x14, every one solved and judged, {len(allowed)} are allowed" in said
    assert f"{optimum['gamma_deg']:.2f} | {optimum['p0_MPa']:.4f}" in said
