"""The order of an error in the size of what it comes from."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd


def order(numbers: np.ndarray, errors: np.ndarray) -> float:
    """p of |error| ~ number^-p, fitted to all of them; numbers: of elements, or of load steps."""
    return -float(np.polyfit(np.log(numbers), np.log(np.abs(errors)), 1)[0])


def orders(table: pd.DataFrame, by: Sequence[str], number: str, errors: Sequence[str]) -> pd.DataFrame:
    """The orders of the columns ``errors`` in the column ``number``, for each of the cases that ``by`` tells apart.

    Columns: those of ``by``, and the errors'.
    """
    rows = []
    for case, own in table.groupby(list(by), sort=False):
        assert isinstance(case, tuple)
        fitted = {name: order(own[number].to_numpy(float), own[name].to_numpy(float)) for name in errors}
        rows.append(dict(zip(by, case, strict=True)) | fitted)
    return pd.DataFrame(rows)
