"""Rigid bodies on soft springs: a wedge that is pushed up a slope, and a block that stays on one or slides.

A block of weight G on a slope of angle a is pushed horizontally by F. It starts to slide upwards at::

    F/G = (tan a + mu)/(1 - mu tan a)

(NAFEMS, CGS-4: 0.412371 at tan a = 0.1, mu = 0.3), and downwards by itself where mu < tan a. The springs carry nothing
until it slides, so that the limit is that of the rigid body.
"""

from __future__ import annotations

import math

import numpy as np
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.coulomb import Coulomb, State
from contact.problem import ContactProblem, ContactSolution, linear_mechanics

SOFT = 1.0  # N/mm


def block(slope: float, mu: float, push: float, weight: float = 1.0) -> ContactSolution:
    """The block on the slope [rad], its forces in N; slip is positive upwards."""
    up, off = np.array([math.cos(slope), math.sin(slope)]), np.array([-math.sin(slope), math.cos(slope)])
    G, S = sparse.csr_matrix(off[None]), sparse.csr_matrix(np.array([up, [0.0, 0.0]]))
    mechanics = linear_mechanics(sparse.csc_matrix(SOFT * np.eye(2)), np.array([push, -weight]))
    law = Coulomb(np.full(1, mu), lambda u: (S @ u).reshape(1, 2), lambda u: S)
    problem = ContactProblem(mechanics, lambda u: G @ u, lambda u: G, np.ones(1), coulomb=law)
    return Semismooth().solve(problem, ContactSolution.at_rest(2, 1))


def pushed_up(slope: float = math.atan(0.1), mu: float = 0.3, digits: float = 1e-9) -> float:
    """F/G at which the wedge begins to slide upwards, by bisection of its state."""
    low, high = math.tan(slope), 2.0
    while high - low > digits:
        middle = (low + high) / 2
        slides = block(slope, mu, middle).rubbed.state[0] == State.SLIP
        low, high = (low, middle) if slides else (middle, high)
    return high
