"""Reference tables as read or computed elsewhere; each file states its source and status in its first lines."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

DATA = Path(__file__).parent


def read_reference(name: str) -> pd.DataFrame:
    """A reference table, its # lines skipped."""
    return pd.read_csv(DATA / name, comment="#")
