"""What stopped a solve, in words without numbers."""

from __future__ import annotations

import re

TANGENT = {  # what the end of a reason begins with, and what it says in short
    "limit point of the path": "the tangent shows a limit point",
    "bifurcation near": "the tangent shows a bifurcation",
    "no limit point": "the tangent gives no reason",
    "too few converged steps": "too few steps converged to tell why",
}


def cause(reason: str) -> str:
    """What stopped a solve, and what the tangent says of it, without numbers, so that equal causes are counted."""
    first, *more = str(reason).split("; ")
    for begin, short in TANGENT.items():
        if first.startswith(begin):
            return short
    told = [short for clause in more for begin, short in TANGENT.items() if clause.startswith(begin)]
    return ", ".join([re.split(r" \(|, \d|: ", first)[0] if told else first, *told[:1]])
