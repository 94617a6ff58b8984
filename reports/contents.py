"""The table of contents: all chapters in groups, in the order of the report.

A page from outside is one file and one line, ``from reports.contents import CHAPTERS; CHAPTERS.append(Chapter(...))``,
and stands in the group that it names.
"""

from __future__ import annotations

from dataclasses import replace

from reports.chapter import Chapter
from reports.chapters import (
    algorithms,
    claims,
    convergence,
    cost,
    data,
    extremes,
    faces,
    friction,
    gallery,
    invariance,
    measures,
    programs,
    shell_limits,
    tyre,
    what_if,
)

GROUPS = {
    "Answers": (measures, shell_limits, what_if, claims),
    "Verification": (tyre, convergence, invariance),
    "Contact": (algorithms, friction, faces, extremes),
    "Cost": (cost, programs),
    "Catalogue": (gallery, data),
}
CHAPTERS: list[Chapter] = [replace(each.CHAPTER, group=group) for group, modules in GROUPS.items() for each in modules]
"""The pages, a folder for each subject. Only tables are read; nothing of ours beside :mod:`reports` is imported."""
