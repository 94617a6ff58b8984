"""A shell along a path that is a power series: what the orders before leave to the next one, on the unknowns.

The recurrence of the elements is :mod:`formulations.element.series`. Who follows the path does not enter here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from formulations.discretisation import Discretisation
from formulations.element.series import ElementSeries
from formulations.shell import ShellModel


@dataclass(frozen=True, eq=False)
class ShellSeries:
    """The recurrence at one point of the path."""

    discretisation: Discretisation
    elements: ElementSeries

    @classmethod
    def of(cls, model: ShellModel, u: np.ndarray, order: int) -> ShellSeries:
        """At the free displacements u (n,), up to u_order; raises ValueError where there is none."""
        shell = model.discretisation
        v = shell.of_elements(u, model.prescribed)
        return cls(shell, ElementSeries(model.polynomial, shell.geometry, v, order))

    def add(self, du: np.ndarray) -> np.ndarray:
        """R_{k+1} (n,) [N] once u_k (n,) is known: called with k = 1, 2, ... in turn."""
        shell = self.discretisation
        return shell.gather(self.elements.add(shell.moved(du)))
