"""The table of contents: all chapters in groups, in the order of the report.

A page from outside is one file and one line, ``from reports.contents import CHAPTERS; CHAPTERS.append(Chapter(...))``,
and stands in the group that it names.
"""

from __future__ import annotations

from dataclasses import replace

from reports.chapter import Chapter
from reports.chapters.catalogue import gallery
from reports.chapters.contact import algorithms
from reports.chapters.friction import page as friction
from reports.chapters.limits import extremes, invariance, shell_limits
from reports.chapters.overview import claims, data
from reports.chapters.shells import convergence, measures
from reports.chapters.trade import cost, programs
from reports.chapters.tyre import page as tyre

GROUPS = {
    "Answers": (measures, shell_limits, claims),
    "Verification": (tyre, convergence, invariance),
    "Contact": (algorithms, friction, extremes),
    "Cost": (cost, programs),
    "Catalogue": (gallery, data),
}
CHAPTERS: list[Chapter] = [replace(each.CHAPTER, group=group) for group, modules in GROUPS.items() for each in modules]
"""The pages, a folder for each subject. Only tables are read; nothing of ours beside :mod:`reports` is imported."""
