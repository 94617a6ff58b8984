"""Experiments, each of which makes a table: makers yield their rows, and are called for the table."""

from collections.abc import Callable, Iterable, Mapping
from functools import wraps
from typing import Any, ParamSpec

import pandas as pd

Row = dict[str, Any]
Asked = ParamSpec("Asked")


def tabulated(rows: Callable[Asked, Iterable[Mapping[str, Any]]]) -> Callable[Asked, pd.DataFrame]:
    """The maker whose rows these are; a column is where its name comes first, NaN in rows that do not have it."""

    @wraps(rows)
    def table(*args: Asked.args, **options: Asked.kwargs) -> pd.DataFrame:
        return pd.DataFrame(list(rows(*args, **options)))

    return table
