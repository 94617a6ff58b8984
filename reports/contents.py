"""The table of contents: all chapters in groups, in the order of the report.

A page from outside is one file and one line, ``from reports.contents import CHAPTERS; CHAPTERS.append(Chapter(...))``,
and stands in the group that it names.
"""

from __future__ import annotations

from dataclasses import replace

from reports.chapter import Chapter
from reports.chapters.answers import findings, glossary, questions
from reports.chapters.arena import page as arena
from reports.chapters.catalogue import gallery
from reports.chapters.contact import agreement, algorithms, epsilon
from reports.chapters.friction import algorithms as friction_algorithms
from reports.chapters.friction import tyre as friction
from reports.chapters.limits import extremes, fuzz, shell_limits, symmetry
from reports.chapters.overview import data, solved
from reports.chapters.shells import benchmarks, convergence, locking, measures, rigid_body
from reports.chapters.trade import advice, cost, tradeoff
from reports.chapters.tyre import page as tyre
from reports.chapters.validation import experiment, manufactured

GROUPS = {
    "Answers": (questions, measures, advice, shell_limits),
    "Verification": (*(tyre, benchmarks, convergence, manufactured, rigid_body, locking, symmetry, fuzz, experiment),),
    "Contact": (agreement, algorithms, epsilon, friction, friction_algorithms, extremes),
    "Arena": (arena,),
    "Cost": (tradeoff, cost),
    "Catalogue": (gallery, glossary),
    "Data": (solved, findings, data),
}
CHAPTERS: list[Chapter] = [replace(each.CHAPTER, group=group) for group, modules in GROUPS.items() for each in modules]
"""The pages, a folder for each subject. Only tables are read; nothing of ours beside :mod:`reports` is imported."""
