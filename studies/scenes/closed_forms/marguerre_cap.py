"""Shallow spherical cap, axisymmetric: the equations of Marguerre and Reissner by collocation, an independent judge.

With x = r/a, the rotation beta = w' (w down), psi = r N_r, depth of the cap r^2/2R and downward pressure p:

    D (r beta'' + beta' - beta/r)  =  p r^2/2 + psi (beta + r/R)
    r psi'' + psi' - psi/r         =  -E h beta (r/R + beta/2)

regular at the apex (beta and psi odd), clamped at r = a: beta = 0, u = 0, which is psi' = nu psi/r.
Source: Budiansky, in: Proc. IUTAM Symp. Theory of Thin Elastic Shells, Delft (1959), 64-94 (recalled); derived here.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

POINTS = 60  # of a curve that is searched for its first maximum
DEGREE = 24  # odd Chebyshev polynomials T1, T3, ...; twice as many change the pressures by less than 1e-9


def shallowness(rise: float, h: float, nu: float) -> float:
    """Geometric parameter lam = 2 (3 (1 - nu^2))^(1/4) sqrt(H/h) of a cap of rise H."""
    return float(2 * (3 * (1 - nu**2)) ** 0.25 * np.sqrt(rise / h))


def classical_pressure(E: float, nu: float, R: float, h: float) -> float:
    """Buckling pressure of the whole sphere, 2 E (h/R)^2/sqrt(3 (1 - nu^2)) [MPa]."""
    return float(2 * E * (h / R) ** 2 / np.sqrt(3 * (1 - nu**2)))


@dataclass(frozen=True, eq=False)
class ShallowCap:
    """The clamped cap of base radius a on a sphere of radius R; ``degree``: number of polynomials each."""

    E: float
    nu: float
    R: float
    a: float
    h: float
    degree: int = DEGREE

    def at_deflection(self, w0: float, start: np.ndarray | None = None) -> tuple[float, np.ndarray]:
        """Pressure [MPa] that sinks the apex by w0 [mm], and the unknowns to start the next deflection from.

        The unknowns are the coefficients of beta and psi and the pressure. Raises ArithmeticError when Newton fails.
        """
        n = self.degree
        y = np.zeros(2 * n + 1) if start is None else start.copy()
        for _ in range(30):
            residual, slope = self._equations(y, w0)
            step = np.linalg.solve(slope, -residual)
            y += step
            if np.max(np.abs(step)) <= 1e-10 * np.max(np.abs(y)):
                return float(y[-1]) * classical_pressure(self.E, self.nu, self.R, self.h), y
        raise ArithmeticError(f"no convergence at w0 = {w0:g}")

    def curve(self, deflections: np.ndarray) -> np.ndarray:
        """Pressures [MPa] at growing deflections of the apex [mm]."""
        pressures, y = [], None
        for w0 in deflections:
            p, y = self.at_deflection(float(w0), y)
            pressures.append(p)
        return np.array(pressures)

    def snap(self, largest: float) -> tuple[float, float]:
        """First maximum of the pressure [MPa] and its deflection [mm], by a parabola through three close points.

        Raises ArithmeticError when the pressure only grows up to the deflection ``largest``.
        """
        w = np.linspace(0, largest, POINTS + 1)[1:]
        for _ in range(4):
            p = self.curve(w)
            top = int(np.argmax(np.diff(p) < 0))
            if top == 0:
                raise ArithmeticError(f"no limit point up to w0 = {w[-1]:g}")
            w = np.linspace(w[top - 1], w[top + 1], 5)
        a, b, c = np.polyfit(w - w[2], self.curve(w), 2)
        vertex = -b / (2 * a)
        return float(np.polyval((a, b, c), vertex)), float(w[2] + vertex)

    def _equations(self, y: np.ndarray, w0: float) -> tuple[np.ndarray, np.ndarray]:
        """Residual and Jacobian of beta, psi/(E h a) and p/p_classical, lengths over a."""
        n = self.degree
        x, (T, dT, ddT), depth = _basis(n)
        b, s = y[:n], y[n : 2 * n]
        k = self.a / self.R
        stiff = (self.h / self.a) ** 2 / (12 * (1 - self.nu**2))  # D/(E h a^2)
        load = classical_pressure(self.E, self.nu, self.R, self.h) * self.a / (self.E * self.h)
        bessel = x[:, None] * ddT + dT - T / x[:, None]
        beta, psi = T @ b, T @ s
        ones = np.ones(n)  # T_odd(1) = 1
        slopes = (2 * np.arange(n) + 1.0) ** 2  # T_odd'(1)
        residual = np.concatenate(
            [
                stiff * bessel @ b - load * y[-1] * x**2 / 2 - psi * (beta + k * x),
                bessel @ s + beta * (k * x + beta / 2),
                [ones @ b, (slopes - self.nu * ones) @ s, -depth @ b - w0 / self.a],
            ]
        )
        slope = np.zeros((2 * n + 1, 2 * n + 1))
        m = n - 1
        slope[:m, :n] = stiff * bessel - psi[:, None] * T
        slope[:m, n : 2 * n] = -(beta + k * x)[:, None] * T
        slope[:m, -1] = -load * x**2 / 2
        slope[m : 2 * m, :n] = (k * x + beta)[:, None] * T
        slope[m : 2 * m, n : 2 * n] = bessel
        slope[-3, :n], slope[-2, n : 2 * n], slope[-1, :n] = ones, slopes - self.nu * ones, -depth
        return residual, slope


@cache
def _basis(n: int) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray, np.ndarray], np.ndarray]:
    """Points x (n - 1,), values and two derivatives (n - 1, n) of T1, T3, ... there, their integrals over (0, 1)."""
    x = np.cos(np.pi * (np.arange(n - 1) + 0.5) / (2 * n - 1))
    odd = [np.polynomial.Chebyshev.basis(2 * k + 1) for k in range(n)]
    parts = [np.stack([f.deriv(order)(x) for f in odd], axis=1) for order in (0, 1, 2)]
    return x, (parts[0], parts[1], parts[2]), np.array([f.integ()(1.0) - f.integ()(0.0) for f in odd])
