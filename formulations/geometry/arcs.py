"""The middle of an edge whose ends carry directors: on an arc that meets both, where a straight line would not.

With x^f of the ends b, c on the faces f, d = x^+ - x^- and the thickness h::

    x_a^f = (x_b^f + x_c^f)/2 + (chord^f . turn) director/(8 h^2),
    chord^f = x_c^f - x_b^f,    turn = d_c - d_b,    director = (d_b + d_c)/2

Where the middle lies beside that arc, as on a parallel that is curved in its surface, it turns with the edge::

    x_a^f -> x_a^f + sigma director x chord^f + tau chord^f + nu director

Both halves of such an edge have the same stretch and the same transverse shear, under any rotation. About the straight
middle (x_b + x_c)/2 they differ by (w_b - w_c)/(2R) and (theta_b - theta_c)/2, which locks thin shells.
Points and what they depend on live here: no grid, no displacement.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

# rows for the coordinates (12,) of the points b-, b+, c-, c+
_CHORD, _MIDDLE = (np.kron(np.kron(ends, np.eye(2)), np.eye(3)).reshape(2, 3, 12) for ends in ([-1, 1], [0.5, 0.5]))
_TURN, _DIRECTOR = (np.kron(np.kron(ends, [-1, 1]), np.eye(3)) for ends in ([-1, 1], [0.5, 0.5]))


@dataclass(frozen=True, eq=False)
class Arcs:
    """k edges whose chord, turn and director are affine functions of 12 variables v, and the straight middle linear.

    middle, chord (k, 2, 3, 12), turn, director (k, 3, 12): slopes;  at_rest: chord, turn, director for v = 0.
    beside (3, k, 2): sigma, tau, nu.
    """

    middle: np.ndarray
    chord: np.ndarray
    turn: np.ndarray
    director: np.ndarray
    at_rest: tuple[np.ndarray, np.ndarray, np.ndarray]
    h: float
    beside: np.ndarray

    @classmethod
    def between(cls, x: np.ndarray, h: float, turned: np.ndarray) -> Arcs:
        """Ends at x (k, 12) that move by ``turned`` (k, 12, 12) v."""
        chord, middle = (np.einsum("fxn,knm->kfxm", rows, turned) for rows in (_CHORD, _MIDDLE))
        at_rest = np.einsum("fxn,kn->kfx", _CHORD, x), x @ _TURN.T, x @ _DIRECTOR.T
        beside = np.zeros((3, len(x), 2))
        return cls(middle, chord, _TURN @ turned, _DIRECTOR @ turned, at_rest, h, beside)

    def through(self, offset: np.ndarray) -> Arcs:
        """The same with middles at x_a - (x_b + x_c)/2 = ``offset`` (k, 2, 3) for v = 0."""
        chord, _, director = self.at_rest
        around = np.broadcast_to(director[:, None], chord.shape)
        basis = np.stack([np.cross(around, chord), chord, around], axis=-1)
        left = np.linalg.solve(basis, (offset - self.bow)[..., None])[..., 0]
        return replace(self, beside=np.moveaxis(left, -1, 0))

    @property
    def bow(self) -> np.ndarray:
        """x_a - (x_b + x_c)/2 (k, 2, 3) for v = 0."""
        chord, turn, director = self.at_rest
        return np.asarray(np.einsum("kfx,kx,ky->kfy", chord, turn, director) / (8 * self.h**2))

    def moved(self, v: np.ndarray) -> np.ndarray:
        """x_a(v) - x_a(0) (k, 2, 3) to the digits of v (k, 12)."""
        chord, turn, director = self.at_rest
        by_chord, by_turn, by_director = self._parts(v)
        here = np.einsum("kfx,kx->kf", chord, turn)[..., None] * by_director[:, None]
        change = np.einsum("kfx,kx->kf", chord + by_chord, by_turn) + np.einsum("kfx,kx->kf", by_chord, turn)
        turned = (here + change[..., None] * (director + by_director)[:, None]) / (8 * self.h**2)
        sigma, tau, nu = self.beside[..., None]
        turned += sigma * (
            np.cross(by_director[:, None], chord) + np.cross((director + by_director)[:, None], by_chord)
        )
        turned += tau * by_chord + nu * by_director[:, None]
        return np.asarray(np.einsum("kfxn,kn->kfx", self.middle, v) + turned)

    def slope(self, v: np.ndarray) -> np.ndarray:
        """d x_a/dv (k, 2, 3, 12)."""
        chord, turn, director = self._at(v)
        bow = np.einsum("kfx,kx->kf", chord, turn)[..., None, None] * self.director[:, None]
        bow = bow + director[:, None, :, None] * self._bow_slope(chord, turn)[:, :, None]
        sigma, tau, nu = self.beside[..., None, None]
        spun = np.cross(director[:, None, :, None], self.chord, axis=2)
        spun = spun + np.cross(self.director[:, None], chord[..., None], axis=2)
        return np.asarray(
            self.middle + bow / (8 * self.h**2) + sigma * spun + tau * self.chord + nu * self.director[:, None]
        )

    def curvature(self, v: np.ndarray, force: np.ndarray) -> np.ndarray:
        """Sum over faces of f . d2 x_a/dv2 (k, 12, 12), of forces f (k, 2, 3) on x_a."""
        chord, turn, director = self._at(v)
        along = np.einsum("kx,kfx->kf", director, force)
        half = np.einsum("kf,kfxm,kxn->kmn", along, self.chord, self.turn)
        half += np.einsum("kfm,kfx,kxn->kmn", self._bow_slope(chord, turn), force, self.director)
        half /= 8 * self.h**2
        across = np.cross(self.chord, (self.beside[0][..., None] * force)[..., None], axis=2)  # f . d x c = d . c x f
        half += np.einsum("kxm,kfxn->kmn", self.director, across)
        return np.asarray(half + half.swapaxes(1, 2))

    def _parts(self, v: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """What v (k, 12) changes chord, turn and director by."""
        chord = np.einsum("kfxn,kn->kfx", self.chord, v)
        return chord, np.einsum("kxn,kn->kx", self.turn, v), np.einsum("kxn,kn->kx", self.director, v)

    def _at(self, v: np.ndarray) -> tuple[np.ndarray, ...]:
        return tuple(rest + change for rest, change in zip(self.at_rest, self._parts(v), strict=True))

    def _bow_slope(self, chord: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """d(chord . turn)/dv (k, 2, 12)."""
        by_chord, by_turn = np.einsum("kx,kfxn->kfn", turn, self.chord), np.einsum("kfx,kxn->kfn", chord, self.turn)
        return np.asarray(by_chord + by_turn)
