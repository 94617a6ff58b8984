"""The pages by file name: their short titles and the line of links under a page's heading."""

from __future__ import annotations

from collections.abc import Mapping

TITLES: Mapping[str, str] = {
    "index.md": "All results",
    "tyre.md": "The tyre",
    "benchmarks.md": "Benchmarks without contact",
    "convergence.md": "Convergence",
    "measures.md": "Strain measures",
    "rigid-body.md": "Rigid motions",
    "locking.md": "Locking",
    "symmetry.md": "Symmetry",
    "extremes.md": "Extremes",
    "contact-agreement.md": "Contact: agreement",
    "algorithms.md": "Contact: costs",
    "epsilon.md": "Contact: ε",
    "cost.md": "Cost",
}
ANALYSIS_TITLES: Mapping[str, str] = {"tradeoff.md": "The trade", "advice.md": "Advice"}  # not of every store


def links(page: str) -> str:
    """Links to all pages but this one."""
    return " · ".join(f"[{title}]({name})" for name, title in TITLES.items() if name != page)
