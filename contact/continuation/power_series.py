"""A piece of an equilibrium curve as a power series, from one factorisation: the asymptotic-numerical method.

Where the model is quadratic, r(u) = t f has the solutions u = sum u_k a^k, t = sum t_k a^k; order k is linear, with the
tangent of the point that the series sets out from and what the lower orders leave::

    K_T u_1 = t_1 f,  |x_1| = 1          K_T u_k = t_k f - R_k,  x_k . x_1 = 0          x_k = (m u_k, t_k)

so that a is the length along the tangent. The sum converges up to the nearest complex branch point of the curve; the
rational functions of :class:`Piece` with the same coefficients reach two to five times as far (measured). How far they
are right, the residual says. What makes R_k is the model's own business and does not enter here.
Without contact alone: a series ends where the contact set changes, and there are 26 (strip) to 326 (plate) changes on
ways that Newton's method makes in 7 to 13 iterations (scenes with contact on 64 elements, tyre on 42x40: 106, 13).
Sources: Cochelin, Int. J. Comput. Struct. 53 (1994) 1181-1192; Cochelin, Potier-Ferry, Int. J. Numer. Meth. Engng 37
(1994) 1187-1203; Cochelin, Damil, Potier-Ferry, Méthode asymptotique numérique (2007); rational: Elhage-Hussein,
Potier-Ferry, Damil, Int. J. Solids Struct. 37 (2000) 6981-7001.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.polynomial import Chebyshev
from scipy.linalg import solve_triangular

from contact.continuation.equilibrium_curve import ArcPoint

DEGREE = 48  # of the interpolant of the load on a piece, whose roots are events
LENGTHS = np.geomspace(1e-2, 10.0, 150)  # over the radius of the series, at which its precision is looked at
TINY = 1e-60  # of the last order over the first, below which the curve is a line; no power of a radius overflows
REAL = 1e-6  # imaginary part of a root of it over the length of the piece, below which it is a point of the curve


class Expansion(Protocol):
    """The recurrence of a quadratic model at the point that a series sets out from."""

    def add(self, du: np.ndarray) -> np.ndarray:
        """R_{k+1} (n,) once u_k (n,) is known; called with k = 1, 2, ... in turn."""


Expand = Callable[[np.ndarray, int], Expansion]  # (u, order)


@dataclass(frozen=True, eq=False)
class Piece:
    """The curve from a point on, as far as a = length: x = (u, t) as a vector of rational functions of a.

    With d_0 = 1 and D_i(a) = sum_{j<=i} d_j a^j::

        x(a) = x_0 + sum_{k=1}^{N-1} x_k a^k D_{N-1-k}(a) / D_{N-1}(a)

    has the coefficients x_k up to the order N-1; the d_j are those with which x_N + d_1 x_{N-1} + ... + d_{N-1} x_1 is
    least.  x (N+1, n+1): coefficients.  radius: a over it is the variable of d (N,), whose powers are not too small.
    """

    x: np.ndarray
    d: np.ndarray
    radius: float
    length: float

    @classmethod
    def of(cls, x: np.ndarray, m: float, precision: float) -> Piece:
        """From coefficients x (N + 1, n + 1), of which displacements count m times.

        As long as the orders N and N-1 agree to the ``precision``, relative to the way from x_0.
        """
        order = len(x) - 1
        scaled = x[1:] * np.append(np.full(x.shape[1] - 1, m), 1.0)
        sizes = np.linalg.norm(scaled, axis=1)
        radius = float((sizes[0] / max(sizes[-1], TINY * sizes[0])) ** (1.0 / (order - 1)))
        scaled *= (radius ** np.arange(1.0, order + 1))[:, None]
        R = np.asarray(np.linalg.qr(scaled.T, mode="r"))
        d = _denominator(R)
        lengths = radius * LENGTHS
        (D, shares), (lower, before) = (_shares(each, lengths, radius) for each in (d, _denominator(R[:, :-1])))
        way = shares[:, 1:] / radius ** np.arange(1, order + 1)
        apart = way[:, :-1] - before[:, 1:] / radius ** np.arange(1, order)
        off = np.linalg.norm(R[:, :-1] @ apart.T, axis=0) > precision * np.linalg.norm(R @ way.T, axis=0)
        wrong = off | (D <= 0) | (lower <= 0)
        first = int(np.argmax(wrong)) if wrong.any() else len(lengths)
        return cls(x, d, radius, float(lengths[max(first - 1, 0)]))

    @property
    def order(self) -> int:
        """N."""
        return len(self.x) - 1

    def at(self, a: float) -> tuple[np.ndarray, float]:
        """u (n,) and load factor at the length a."""
        x = _shares(self.d, np.asarray(a), self.radius)[1] @ self.x
        return x[:-1], float(x[-1])

    def cut(self, length: float) -> Piece:
        """The same up to another length."""
        return replace(self, length=length)

    def tangent(self, a: float) -> np.ndarray:
        """dx/da (n + 1,) at the length a."""
        t = a / self.radius
        powers = t ** np.arange(self.order)
        D = np.cumsum(self.d * powers)
        slope = np.cumsum(self.d * np.append(0.0, np.arange(1, self.order) * powers[:-1])) / self.radius
        k = np.arange(self.order)
        by_power = k * np.append(0.0, a ** k[:-1]) * D[::-1] / D[-1]
        by_share = a**k * (slope[::-1] * D[-1] - D[::-1] * slope[-1]) / D[-1] ** 2
        return (by_power + by_share) @ self.x[:-1]

    @cached_property
    def load(self) -> Chebyshev:
        """The load factor over the length: the interpolant in Chebyshev's points, which is right to rounding."""
        return Chebyshev.interpolate(
            lambda a: _shares(self.d, a, self.radius)[1] @ self.x[:, -1], DEGREE, domain=[0.0, self.length]
        )

    def passes(self, factor: float) -> list[float]:
        """The lengths at which the load factor is this, in order."""
        return self._lengths(self.load - factor)

    def limits(self) -> list[float]:
        """The lengths at which the load is stationary, in order."""
        return self._lengths(self.load.deriv())

    def _lengths(self, function: Chebyshev) -> list[float]:
        constant, *others = function.coef
        if abs(constant) > np.sum(np.abs(others)):
            return []  # it has one sign
        roots = function.trim(1e-15 * float(np.abs(function.coef).max())).roots()
        real = roots.real[np.abs(roots.imag) <= REAL * self.length]
        return sorted(real[(real > 0) & (real <= self.length)].tolist())


@dataclass(frozen=True, eq=False)
class SeriesCurve:
    """A curve from rest on, piece by piece; a place on it is the sum of the lengths up to there."""

    pieces: tuple[Piece, ...]

    def at(self, factor: float, passage: int = 0) -> ArcPoint:
        """The point where the load passes this factor, as in :meth:`contact.continuation.arc_length.Trace.at`."""
        before, passed = 0.0, 0
        for piece in self.pieces:
            lengths = piece.passes(factor)
            if passage - passed < len(lengths):
                return _point(piece, lengths[passage - passed], before)
            passed += len(lengths)
            before += piece.length
        times = f"passes {passed} times, not {passage + 1}," if passed else "does not pass"
        raise LookupError(f"the curve {times} the load factor {factor:g}")

    def sampled(self, parts: int) -> Iterator[ArcPoint]:
        """Points of the curve, ``parts`` on every piece, its end included; rest is none of them."""
        before = 0.0
        for piece in self.pieces:
            yield from (_point(piece, piece.length * (i + 1) / parts, before) for i in range(parts))
            before += piece.length


def _point(piece: Piece, a: float, before: float) -> ArcPoint:
    return ArcPoint(*piece.at(a), rising=bool(piece.tangent(a)[-1] > 0), along=before + a)


def _denominator(R: np.ndarray) -> np.ndarray:
    """d (N,) of orthogonal coordinates R (.., N) of the orders 1 to N.

    (1, 0, ..., 0), which leaves the sum itself, where they depend on one another, as those of few unknowns do.
    """
    order = R.shape[1]
    d, size = np.append(1.0, np.zeros(order - 1)), np.abs(np.diag(R)[: order - 1])
    if len(size) == order - 1 and size.min() > np.finfo(float).eps * np.abs(R).max():
        d[1:] = solve_triangular(R[: order - 1, : order - 1], -R[: order - 1, -1])[::-1]
    return d


def _shares(d: np.ndarray, a: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """The denominator D_{N-1} at lengths a (...), and shares (..., N + 1) with x(a) = shares . x."""
    k = np.arange(len(d))
    D = np.cumsum(d * (a[..., None] / radius) ** k, axis=-1)
    shares = np.zeros((*a.shape, len(d) + 1))
    shares[..., :-1] = a[..., None] ** k * D[..., ::-1] / D[..., -1:]
    return D[..., -1], shares
