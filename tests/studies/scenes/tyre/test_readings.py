"""What is read off a patch, by pressures and places that are given."""

import numpy as np
import pytest

from studies.scenes.contact.extent import half_extent
from studies.scenes.tyre.readings import to_edges


def test_the_rim_is_where_pressures_that_fall_linearly_leave_off() -> None:
    """The last node has half of what the two before it lead to: half of its share of the line is in contact."""
    x, fall = np.arange(-4.0, 5.0), np.array([4.0, 3.0, 2.0, 0.5, 0.0])
    p = np.concatenate([fall[:0:-1], fall])
    assert half_extent(x, p > 0, p) == pytest.approx(3.0)
    assert half_extent(x, p > 0) == pytest.approx(3.5)


def test_the_nearer_edge_counts() -> None:
    x = np.zeros((5, 2, 3))
    x[..., 2] = np.arange(5.0)[:, None]
    for node, length in ((1, 1.0), (2, 2.0), (3, 1.0)):
        active = np.zeros((5, 2), bool)
        active[node, 0] = True
        assert to_edges(x, active) == length
    assert to_edges(x, np.zeros((5, 2), bool)) == 4.0
