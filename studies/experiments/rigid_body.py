"""What every measure leaves under rigid motions: measured strains beside the declared closed forms, as tables.

No mesh and no element: a rigid motion of the two faces is sent through the displacement gradients at points of a
surface, derivatives of its components by 8th-order differences.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import numpy as np

from formulations.geometry.surfaces import Plate, Surface, cylinder, sphere, torus
from formulations.strains.catalogue import MEASURES
from formulations.strains.measure import StrainMeasure
from formulations.strains.quantities import FULL, STRAINS, gradient_coefficients, shear_row_factors
from studies.experiments import Row, tabulated
from studies.scenes.manufactured.statements import CENTRAL_8

STEP = 0.015
FACES = (-0.1, 0.3)  # d- and d+ of the sample shell, R = 1 or 2

# name -> surface, sample point (a1, a2), a length to measure translations by
SAMPLES: dict[str, tuple[Surface, tuple[float, float], float]] = {
    "plate": (Plate(), (0.3, -0.2), 1.0),
    "cylinder": (cylinder(2.0), (0.4, 0.7), 2.0),
    "sphere": (sphere(2.0), (0.0, 0.7), 2.0),
    "torus": (torus(3.0, 1.0), (0.0, 0.7), 4.0),
}
CASES = tuple(product(SAMPLES, ("translation", "out of plane", "drilling", "about the axis")))
AMOUNTS = (0.2, 0.1, 0.05)
SWEPT = (("plate", "out of plane"), ("plate", "drilling"), ("cylinder", "about the axis"), ("sphere", "out of plane"))


@dataclass(frozen=True)
class Motion:
    """x -> R x + c; ``strain``: the row of E to look at; ``declared(measure)``: its closed form, None where none is."""

    rotation: np.ndarray
    translation: np.ndarray
    strain: str
    declared: Callable[[StrainMeasure], float | None]


def rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rotation matrix about a unit axis (Rodrigues)."""
    x, y, z = axis
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K)


@lru_cache(maxsize=256)
def displacements(surface: str, motion: str, theta: float, slide: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """v (1, 6) of both faces of a sample, dv/da1 and dv/da2 at its point: the same for every measure."""
    shape, point, _ = SAMPLES[surface]
    moved = motions(surface, theta, slide)[motion]
    R, c = moved.rotation, moved.translation
    a1, a2 = (np.array([value]) for value in point)

    def components(b1: np.ndarray, b2: np.ndarray) -> np.ndarray:
        x, frame = shape.position(b1, b2), shape.frame(b1, b2)
        v = np.empty((1, 6))
        for face, d in enumerate(FACES):
            u = (x + d * frame[:, 2]) @ (R - np.eye(3)).T + c
            v[:, face::2] = np.einsum("...ij,...j->...i", frame, u)
        return v

    values = (
        components(a1, a2),
        central_difference(lambda t: components(a1 + t, a2)),
        central_difference(lambda t: components(a1, a2 + t)),
    )
    for value in values:
        value.setflags(write=False)
    return values


def residual_strains(measure: StrainMeasure, surface: str, motion: str, theta: float, slide: float) -> np.ndarray:
    """The 11 strains that a motion leaves at the sample point of a surface."""
    shape, point, _ = SAMPLES[surface]
    values = displacements(surface, motion, theta, slide)
    geometry = shape.geometry(*(np.array([value]) for value in point))
    coefficients = gradient_coefficients(geometry, *FACES, measure.kinematics)
    q = np.sum([np.einsum("...qv,...v->...q", C, v) for C, v in zip(coefficients, values, strict=True)], axis=0)
    return np.asarray((measure.strain(q) * shear_row_factors(geometry, *FACES, measure.kinematics))[0])


def central_difference(f: Callable[[float], np.ndarray | float], step: float = STEP) -> np.ndarray:
    """df/dt at t = 0, error of the order step^8."""
    differences = [weight * (np.asarray(f(j * step)) - np.asarray(f(-j * step))) for j, weight in CENTRAL_8]
    return np.asarray(np.sum(differences, axis=0) / step)


def motions(surface: str, theta: float, slide: float) -> dict[str, Motion]:
    """Four motions of a sample: ``slide`` lengths along x, the angle ``theta`` about e2, about e3, about the z axis."""
    shape, point, length = SAMPLES[surface]
    at = tuple(np.array([value]) for value in point)
    frame, k = shape.frame(*at)[0], shape.geometry(*at).k[0]
    zeta = 1 + k * FACES[1]
    c = slide * length * np.array([1.0, 0, 0])
    slope = float(c @ frame[1]) * k[1]

    def about_e2(measure: StrainMeasure) -> float | None:
        if k[0] == 0:
            return measure.rigid_body_law.out_of_plane(theta, 1.0)
        if surface == "torus" and measure.kinematics.shallow:
            return None  # its v1 depends on the distance from the axis, not on k1
        return measure.rigid_body_law.axis(theta, float(zeta[0]))

    def about_e3(measure: StrainMeasure) -> float | None:
        full = surface == "plate" or measure.kinematics == FULL
        return measure.rigid_body_law.drilling(theta, 1.0) if full else None

    def about_z(measure: StrainMeasure) -> float | None:
        law = measure.rigid_body_law
        return law.drilling(theta, 1.0) if surface == "plate" else law.axis(theta, float(zeta[1]))

    def along_x(measure: StrainMeasure) -> float | None:
        return measure.rigid_body_law.translation(slope, float(zeta[1]))

    still, z = np.zeros(3), np.array([0.0, 0, 1])
    return {
        "translation": Motion(np.eye(3), c, "E22+", along_x),
        "out of plane": Motion(rotation(frame[1], theta), still, "E11+", about_e2),
        "drilling": Motion(rotation(frame[2], theta), still, "E11+", about_e3),
        "about the axis": Motion(rotation(z, theta), still, "E22+", about_z),
    }


@tabulated
def rigid_body_table(theta: float = 0.5, slide: float = 0.3) -> Iterator[Row]:
    """All measures x surfaces x motions: a strain on the outer face, its declared value, the largest |E| of all 11.

    ``declared`` is missing where no closed form is declared. A measure with full gradients follows its plate laws on
    every surface, because its q depends on R alone.
    """
    for measure, case in product(MEASURES.values(), CASES):
        row = left_by(measure, *case, theta, slide)
        yield row | {"theta_rad": 0.0 if row["motion"] == "translation" else theta, "slide": slide}


@tabulated
def small_motions() -> Iterator[Row]:
    """The same under motions that halve, from which rates and coefficients are fitted.

    amount: an angle [rad], of a translation a share of the length of the sample.
    """
    for a, measure, case in product(AMOUNTS, MEASURES.values(), CASES):
        yield {**left_by(measure, *case, a, a), "amount": a}


@tabulated
def rotation_sweep(points: int = 73) -> Iterator[Row]:
    """Strains on the outer face over a full turn, beside the declared ones: the cases SWEPT."""
    for t, case, measure in product(np.linspace(0, 2 * np.pi, points).tolist(), SWEPT, MEASURES.values()):
        yield {**left_by(measure, *case, t, 0.0), "theta_rad": t}


def left_by(measure: StrainMeasure, surface: str, motion: str, theta: float, slide: float) -> Row:
    """What a motion leaves at the sample point of a surface: a row of the tables."""
    m = motions(surface, theta, slide)[motion]
    E = residual_strains(measure, surface, motion, theta, slide)
    return {
        "measure": measure.name,
        "surface": surface,
        "motion": motion,
        "strain": float(E[STRAINS.index(m.strain)]),
        "declared": m.declared(measure),
        "largest": float(np.max(np.abs(E))),
    }
