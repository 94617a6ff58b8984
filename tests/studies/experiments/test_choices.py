"""What is enough in a regime: the rows of a choice, against a limit that others have published."""

import math

import pandas as pd
import pytest

from studies.cli import OK, main
from studies.experiments.choices import (
    ALGORITHM,
    COLUMNS,
    GRID,
    OFFER,
    PATCH,
    SMALL,
    VARIANT,
    Ask,
    choices,
    measure_limits,
    shipped_asks,
)


@pytest.mark.slow
def test_the_reference_is_the_limit_of_the_exact_measure_and_what_is_recommended_holds(tmp_path) -> None:
    """Linear strains have the limit of the published 0.3024, with shear and without its beam stiffness 0.301."""
    roof = choices([Ask(SMALL, "scordelis-lo", {}, None, 120.0)], [0.1])
    assert tuple(roof.columns) == COLUMNS
    own, linear = (roof[(roof["row"] == VARIANT) & (roof["name"] == name)].iloc[0] for name in ("exact", "linear"))
    assert abs(own["formulation_error"]) <= own["within"]  # two faces are enough for so thin a wall
    assert own["limit"] * (1 + linear["formulation_error"]) == pytest.approx(0.3010, rel=0.01)
    assert (linear["verdict"], own["verdict"]) == ("not enough", "enough")
    offer = roof[roof["row"] == OFFER].iloc[0]
    assert offer["error_at_most"] <= 0.1
    line = offer["command"].replace("DIR", str(tmp_path)).split()
    assert main([*line[1:], "--no-error"]) == OK
    assert roof[roof["row"] == GRID]["error_at_most"].min() <= 0.1


@pytest.mark.slow
def test_what_is_known_for_a_smaller_error_serves_a_larger_one() -> None:
    """One limit, one error a grid, a mesh no finer; the algorithms are tried once."""
    table = choices([Ask(PATCH, "ring", {"delta_mm": "50"}, None, 20.0)], [0.01, 0.1])
    exact = table[(table["row"] == GRID) & (table["name"] == "exact")]
    coarse, fine = (exact[exact["asked"] == error].set_index("mesh") for error in (0.1, 0.01))
    assert coarse["error_at_most"].equals(fine["error_at_most"])
    assert table["limit"].nunique() == 1
    offers = table[table["row"] == OFFER].drop_duplicates("asked").set_index("asked")
    meshes = offers["mesh"].map(lambda mesh: int(mesh.split("x")[1]))
    assert (meshes[0.1] < meshes[0.01], bool(offers.loc[0.1, "tried"])) == (True, True)
    assert offers.loc[0.1, "error_at_most"] <= 0.1
    own = table[table["row"] == ALGORITHM].set_index("name")
    assert set(own["asked"]) == {0.01}
    assert {"semismooth", "lcp", "qp", "trial-and-error"} <= set(own.index)
    assert own.loc["semismooth", "seconds"].max() > 0


def test_every_regime_has_two_scenes_or_more() -> None:
    count = pd.Series([(ask.regime, ask.scene) for ask in shipped_asks()]).drop_duplicates().map(lambda each: each[0])
    assert count.value_counts().min() >= 2


def test_a_limit_from_grids_coarser_than_half_the_exact_one_s_is_marked() -> None:
    """500 unknowns are half of 1000, 499 are not; of two errors the smaller one that has a limit counts."""
    base = {"axis": "measure", "scene": "ring", "settings": "", "within": 0.01, "regime": "contact"}
    finest = {"exact": 1000.0, "donnell": 499.0, "sanders": 500.0}
    grids = [{**base, "row": "grid", "name": name, "asked": 0.01, "unknowns": n} for name, n in finest.items()]
    limits = {("donnell", 0.05): 0.3, ("donnell", 0.01): math.nan, ("sanders", 0.05): 0.2, ("sanders", 0.01): 0.1}
    rows = [
        {**base, "row": "variant", "name": name, "asked": asked, "formulation_error": error}
        for (name, asked), error in limits.items()
    ]
    table = measure_limits(pd.DataFrame([*grids, *rows])).set_index("name")
    assert table["formulation_error"].to_dict() == {"donnell": 0.3, "sanders": 0.1}
    assert table["coarse"].to_dict() == {"donnell": True, "sanders": False}
