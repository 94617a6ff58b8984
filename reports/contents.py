"""The list of all chapters, in the order of the report; a page from outside is one file and one line:

``from reports.contents import CHAPTERS; CHAPTERS.append(Chapter(...))``.
"""

from __future__ import annotations

from reports.chapter import Chapter
from reports.chapters.contact import agreement, algorithms, epsilon
from reports.chapters.limits import extremes, fuzz, shell_limits, symmetry
from reports.chapters.shells import benchmarks, convergence, locking, measures, rigid_body
from reports.chapters.trade import advice, cost, tradeoff
from reports.chapters.tyre import page as tyre
from reports.chapters.validation import experiment, manufactured

MECHANICS = (
    *(tyre, benchmarks, convergence, manufactured, measures, rigid_body, locking, symmetry, extremes, fuzz),
    *(shell_limits, experiment),
)
SOLVING = (agreement, algorithms, epsilon, tradeoff, advice, cost)
CHAPTERS: list[Chapter] = [each.CHAPTER for each in (*MECHANICS, *SOLVING)]
