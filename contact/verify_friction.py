"""The judge of friction: what the law is worth by (problem, u, forces) alone; it trusts no algorithm.

Normal direction: friction is taken as a given load, and :mod:`contact.verify` judges the contact problem under it,
each force divided by no area. Its energy balance is then that of work, for friction held along the straight way
between two states has the potential -t.s(u).

Tangential direction, candidate by candidate, F the largest force of a candidate and L a large slip::

    cone       |t| - mu f                    over F          friction beyond its bound
    open       |t| where f <= 0 or g > 0     over F          friction where nothing presses
    stick      |s| where |t| < mu f          over L          a candidate that is held and moves
    direction  |s/|s| + t/|t|| of the rest   0: opposite     less where rounding alone turns s or t, see CHORD
    generated  t.s over all candidates       over L sum|t|   friction that drives

All are relative, so that no unit is a special one. With a finite epsilon the conditions are those of its springs, that
is of g + f/(w epsilon) and s + t/(w epsilon) instead of g and s. No algorithm may enter here.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from contact.coulomb import Coulomb, Sliding
from contact.problem import ContactProblem, Faces, Linearisation

CONE = 1e-9  # of the largest force: friction beyond its bound, or short of it, that is none
CHORD = 1e-6  # by which friction may miss the direction against the slip [-]


@dataclass(frozen=True)
class LawResiduals:
    """The five residuals of friction above by name, each relative.

    length [mm]: a large slip.  force [N]: the largest of a candidate.  slip_bound: size of a slip that is none, of the
    length: what contact allows a gap, and the rounding of a slip.
    """

    by_name: Mapping[str, float]
    length: float
    force: float
    slip_bound: float

    @property
    def bounds(self) -> dict[str, float]:
        """What each may be, by name."""
        none = self.slip_bound
        return {"cone": CONE, "open": CONE, "stick": none, "direction": CHORD, "generated": none}


def residuals_of_law(
    law: Coulomb,
    u: np.ndarray,
    forces: tuple[np.ndarray, np.ndarray],
    give: np.ndarray,
    opened: np.ndarray,
    large: tuple[float, float],
    none: tuple[float, float],
) -> LawResiduals:
    """Of normal forces (m,) and friction (m, 2), give (m,) [mm/N] that of springs, by which slips are longer.

    opened (m,) bool: candidates that nothing presses.  large: a gap [mm] and a normal force [N] that are.  none: share
    of a large slip that is none, and the rounding of what a slip is a difference of.
    """
    normal, friction = forces
    slip, t, bound = law.slip(u) + give[:, None] * friction, _size(friction), law.bound(normal)
    moved = float(np.max(abs(law.slip_jacobian(u)) @ np.abs(u), initial=0.0))
    length = max(large[0], moved, float(np.max(_size(slip), initial=0.0)))
    force = max(large[1], float(np.max(t, initial=0.0)))
    L, F = length or 1.0, force or 1.0
    shortest = none[0] + none[1] * law.slip_size / L
    held = bound - t > CONE * F
    turns = ~(held | opened)
    residuals = {
        "cone": float(np.max(t - bound, initial=0.0)) / F,
        "open": float(np.max(t[opened], initial=0.0)) / F,
        "stick": float(np.max(_size(slip)[held], initial=0.0)) / L,
        "direction": float(np.max(_chord(slip[turns], friction[turns], shortest * L, CONE * F), initial=0.0)),
        "generated": max(0.0, float(np.sum(friction * slip))) / (float(np.sum(t)) * L or 1.0),
    }
    return LawResiduals(residuals, length, force, shortest)


@dataclass(frozen=True, eq=False)
class Rubbed:
    """Faces under friction (m, 2) [N], between which springs have given way (m,) [mm]."""

    faces: Faces
    sliding: Sliding
    friction: np.ndarray
    given: np.ndarray

    def positions(self, u: np.ndarray) -> np.ndarray:
        """All points (k, 3)."""
        return self.faces.positions(u)

    def forces(self, u: np.ndarray, nodal: np.ndarray) -> np.ndarray:
        """Forces (k, 3) on all of them with those of friction."""
        return self.faces.forces(u, nodal) + self.sliding.forces(u, self.friction)

    def measured(self, u: np.ndarray) -> np.ndarray:
        """Gaps (m,) without what springs give way, from distances that are measured anew."""
        return self.faces.measured(u) + self.given

    @property
    def mirrors(self) -> np.ndarray:
        """Those of the faces."""
        return self.faces.mirrors

    @property
    def parts(self) -> tuple[tuple[Faces, slice], ...]:
        """Each pair by itself."""
        pairs = zip(self.faces.parts, self.sliding.each, strict=True)
        return tuple((Rubbed(pair, own, self.friction[its], self.given[its]), its) for (pair, its), own in pairs)


def under(contact: ContactProblem, law: Coulomb, friction: np.ndarray) -> ContactProblem:
    """The contact problem with ``friction`` (m, 2) [N] as a given load, its areas one: pressures are normal forces.

    r(u) - S(u)^T t, with the potential P(u) - t.s(u).
    """
    t = friction.ravel()

    def linearise(u: np.ndarray, memory: object) -> Linearisation:
        lin, pulled = contact.linearise(u, memory), law.slip_jacobian(u).T @ t
        scale = max(lin.scale, float(np.linalg.norm(pulled)))
        return Linearisation(lin.residual - pulled, law.on_tangent(lin.tangent, u, friction), scale, lin.remember)

    def residual(u: np.ndarray) -> np.ndarray:
        alone = contact.linearise(u, None).residual if contact.residual is None else contact.residual(u)
        return np.asarray(alone - law.slip_jacobian(u).T @ t)

    def energy(u: np.ndarray) -> float:
        assert contact.energy is not None
        return contact.energy(u) - float(t @ law.slip(u).ravel())

    return replace(
        contact,
        linearise=linearise,
        residual=residual,
        energy=None if contact.energy is None else energy,
        weights=np.ones(len(law.mu)),
        coupling=None,
        directions=None,
        others=None,
        only=None,
        coulomb=None,
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
