"""What a notebook shows of an answer: a line of text, or that line with a table and remarks as HTML.

Names and sentences may be of parts from outside: all text is escaped. What is said does not enter here.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd

MOST = 20  # rows of the table


class Shown(ABC):
    """An answer that shows itself."""

    @property
    @abstractmethod
    def line(self) -> str:
        """What it is, in one line."""

    @abstractmethod
    def shown(self) -> tuple[pd.DataFrame, list[str]]:
        """Its table, and remarks below it."""

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.line}>"

    def _repr_html_(self) -> str:
        table, remarks = self.shown()
        from pandas import option_context

        with option_context("display.max_colwidth", None):  # meanings are whole sentences
            rows = table.to_html(max_rows=MOST, index=False, float_format=lambda x: f"{x:.6g}", border=0)
        paragraphs = "".join(f"<p>{escape(each)}</p>" for each in remarks)
        return f"<p><strong>{escape(self.line)}</strong></p>{rows}{paragraphs}"
