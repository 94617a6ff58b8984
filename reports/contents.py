"""The table of contents: all chapters in groups, in the order of the report.

A page from outside puts itself into CHAPTERS, and stands in the group that it names: reports/manual/page.md.
"""

from __future__ import annotations

from dataclasses import replace

from reports.chapter import Chapter
from reports.chapters import (
    algorithms,
    convergence,
    cost,
    extremes,
    faces,
    friction,
    gallery,
    index,
    invariance,
    measures,
    shell_limits,
    tyre,
    what_if,
)

GROUPS = {
    "Answers": (measures.CHAPTER, shell_limits.CHAPTER, what_if.CHAPTER, index.LEDGER),
    "Verification": (tyre.CHAPTER, convergence.CHAPTER, invariance.CHAPTER),
    "Contact": (algorithms.CHAPTER, friction.CHAPTER, faces.CHAPTER, extremes.CHAPTER),
    "Cost": (cost.CHAPTER, cost.PROGRAMS),
    "Catalogue": (gallery.CHAPTER, index.APPENDIX),
}
CHAPTERS: list[Chapter] = [replace(each, group=group) for group, chapters in GROUPS.items() for each in chapters]
OURS = frozenset(each.file for each in CHAPTERS)
