"""The judge of friction: what an answer is worth by (problem, u, normal, friction) alone; it trusts no algorithm.

Normal direction: friction is taken as a given load, and :mod:`contact.verify` judges the contact problem under it,
each force divided by no area. Its energy balance is then that of work, for friction held along the straight way
between two states has the potential -t.s(u); see :class:`Work`.

Tangential direction, candidate by candidate, F the largest force of a candidate and L a large slip::

    cone       |t| - mu f                    over F          friction beyond its bound
    open       |t| where f <= 0 or g > 0     over F          friction where nothing presses
    stick      |s| where |t| < mu f          over L          a candidate that is held and moves
    direction  |s/|s| + t/|t|| of the rest   0: opposite     less where rounding alone turns s or t, see CHORD
    generated  t.s over all candidates       over L sum|t|   friction that drives

All are relative, so that no unit is a special one. With a finite epsilon the conditions are those of its springs, that
is of g + f/(w epsilon) and s + t/(w epsilon) instead of g and s. No algorithm may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contact.friction.problem import FrictionalProblem
from contact.problem import ContactProblem, Linearisation
from contact.verify import GAP, POSITION, Verdict
from contact.verify import judge as judge_contact

CONE = 1e-9  # of the largest force: friction beyond its bound, or short of it, that is none
CHORD = 1e-6  # by which friction may miss the direction against the slip [-]
LAW = ("cone", "open", "stick", "direction", "generated")


@dataclass(frozen=True)
class FrictionVerdict:
    """What :mod:`contact.verify` says of the contact under the given friction, and the residuals of the law above.

    contact: its tension is in N, its complementarity in N mm, its ``pressure`` the largest normal force [N].
    length [mm]: a large slip.  force [N]: the largest of a candidate.  slip_rounding: of a zero slip, over length.
    """

    contact: Verdict
    cone: float
    open: float
    stick: float
    direction: float
    generated: float
    length: float
    force: float
    slip_rounding: float

    @property
    def law(self) -> dict[str, float]:
        """The five residuals of friction by name, each relative."""
        return {name: getattr(self, name) for name in LAW}

    @property
    def kkt(self) -> dict[str, float]:
        """The four residuals of contact and the five of friction by name."""
        return {**self.contact.kkt, **self.law}

    @property
    def balances(self) -> dict[str, float]:
        """The balance of work, where there is a potential."""
        return {} if self.contact.energy is None else {"work": self.contact.energy}

    @property
    def certificate(self) -> dict[str, Any]:
        """What a result says of itself: {failures, kkt, balances, rounding, scales}; certified when nothing failed."""
        told = {"failures": self.failures(), "kkt": self.kkt, "balances": self.balances}
        return told | {"rounding": self.contact.rounding, "scales": {"length_mm": self.length, "force_N": self.force}}

    def exceeded(
        self, *, cone: float = CONE, stick: float = GAP, chord: float = CHORD, **contact: float
    ) -> dict[str, tuple[float, float]]:
        """Size and bound of the residuals that are above theirs, by name (NaN counts as above).

        stick: of the length, to which the rounding of a slip is added.  contact: bounds for
        :meth:`contact.verify.Verdict.exceeded`.
        """
        none = stick + self.slip_rounding
        bounds = {"cone": cone, "open": cone, "stick": none, "direction": chord, "generated": none}
        found = {"work" if name == "energy" else name: pair for name, pair in self.contact.exceeded(**contact).items()}
        return found | {name: (size, bounds[name]) for name, size in self.law.items() if not size <= bounds[name]}

    def failures(self, **bounds: float) -> list[str]:
        """The names of the residuals above their bounds, as :meth:`exceeded` takes them."""
        return list(self.exceeded(**bounds))


@dataclass(frozen=True)
class Work:
    """The work [N mm] of one step, from ``since`` to u, forces and loads as they are at its end::

        loads + foundation = dissipation + loss

    loads: their work less the change of the stored energy, -(P(u) - P(since)).  foundation: the work by which its own
    travel, tangential and normal, drives the body, -t.s(since) - f.g(since).  dissipation: -t.s(u).  loss: what is
    lost because forces are those of the end of the step all along it, of second order in its size; never negative
    where the mechanics is stable.
    """

    loads: float
    foundation: float
    dissipation: float
    loss: float


def judge(
    problem: FrictionalProblem,
    u: np.ndarray,
    normal: np.ndarray,
    friction: np.ndarray,
    *,
    epsilon: float = np.inf,
    since: np.ndarray | None = None,
) -> FrictionVerdict:
    """Recompute all residuals; raises ValueError when the forces do not fit the candidates.

    epsilon [MPa/mm]: of springs in both directions, infinite for the exact law.
    since (n,): the last accepted state, from which work is balanced; default the undeformed one.
    """
    m = len(problem.mu)
    if normal.shape != (m,) or friction.shape != (m, 2):
        raise ValueError(f"forces of shapes {normal.shape} and {friction.shape} for {m} contact candidates")
    w = problem.contact.weights
    give = np.divide(1 / epsilon, w, out=np.zeros_like(w), where=w > 0)
    sprung = replace(problem, contact=replace(problem.contact, gap=lambda u: problem.contact.gap(u) + give * normal))
    contact = judge_contact(under(sprung, friction), u, normal, since=since)
    contact = replace(contact, length=max(contact.length, float(np.max(give * np.abs(normal), initial=0.0))))
    slip, t, bound = problem.slip(u) + give[:, None] * friction, _size(friction), problem.bound(normal)
    moved = float(np.max(abs(problem.slip_jacobian(u)) @ np.abs(u), initial=0.0))
    length = max(contact.length, moved, float(np.max(_size(slip), initial=0.0)))
    force = max(contact.pressure, float(np.max(t, initial=0.0)))
    L, F = length or 1.0, force or 1.0
    rounding = POSITION * problem.slip_size / L
    opened = (normal <= 0) | (sprung.contact.gap(u) > contact.gap_bound())
    held = bound - t > CONE * F
    turns = ~(held | opened)
    total = float(np.sum(t)) * L or 1.0
    return FrictionVerdict(
        contact=contact,
        cone=float(np.max(t - bound, initial=0.0)) / F,
        open=float(np.max(t[opened], initial=0.0)) / F,
        stick=float(np.max(_size(slip)[held], initial=0.0)) / L,
        direction=float(np.max(_chord(slip[turns], friction[turns], (GAP + rounding) * L, CONE * F), initial=0.0)),
        generated=max(0.0, float(np.sum(friction * slip))) / total,
        length=length,
        force=force,
        slip_rounding=rounding,
    )


def work(
    problem: FrictionalProblem, u: np.ndarray, normal: np.ndarray, friction: np.ndarray, since: np.ndarray
) -> Work | None:
    """The work of the step, or None without a potential; the judge's ``work`` vouches for the balance."""
    energy = problem.contact.energy
    if energy is None:
        return None
    dissipation = -float(np.sum(friction * problem.slip(u)))
    loads = energy(since) - energy(u)
    foundation = -float(np.sum(friction * problem.slip(since)) + normal @ problem.contact.gap(since))
    return Work(loads, foundation, dissipation, loads + foundation - dissipation)


def under(problem: FrictionalProblem, friction: np.ndarray) -> ContactProblem:
    """The contact problem with ``friction`` (m, 2) [N] as a given load, its areas one: pressures are normal forces.

    r(u) - S(u)^T t, with the potential P(u) - t.s(u).
    """
    contact = problem.contact
    t = friction.ravel()

    def linearise(u: np.ndarray, memory: object) -> Linearisation:
        lin, pulled = contact.linearise(u, memory), problem.slip_jacobian(u).T @ t
        scale = max(lin.scale, float(np.linalg.norm(pulled)))
        return Linearisation(lin.residual - pulled, lin.tangent, scale, lin.remember)

    def residual(u: np.ndarray) -> np.ndarray:
        alone = contact.linearise(u, None).residual if contact.residual is None else contact.residual(u)
        return np.asarray(alone - problem.slip_jacobian(u).T @ t)

    def energy(u: np.ndarray) -> float:
        assert contact.energy is not None
        return contact.energy(u) - float(t @ problem.slip(u).ravel())

    return replace(
        contact,
        linearise=linearise,
        residual=residual,
        energy=None if contact.energy is None else energy,
        weights=np.ones(len(problem.mu)),
        directions=None,
        others=None,
        only=None,
    )


def _size(vectors: np.ndarray) -> np.ndarray:
    """Lengths (m,) of (m, 2)."""
    return np.asarray(np.linalg.norm(vectors, axis=1))


def _chord(slip: np.ndarray, friction: np.ndarray, least_slip: float, least_force: float) -> np.ndarray:
    """|s/|s| + t/|t|| (m,), from 0 for opposite to 2 for alike, times what is known of both directions.

    A slip known to ``least_slip`` is turned by a chord up to 2 least_slip/|s|, or by any where it is that short: times
    |s|/(|s| + 2 least_slip/CHORD) it is at most CHORD, whatever |s|; so for the force.
    """
    s, t = _size(slip), _size(friction)
    both = (s > 0) & (t > 0)
    s, t = s[both], t[both]
    chord = _size(slip[both] / s[:, None] + friction[both] / t[:, None])
    return np.asarray(chord * s / (s + 2 * least_slip / CHORD) * t / (t + 2 * least_force / CHORD))
