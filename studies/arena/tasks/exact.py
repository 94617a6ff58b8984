"""What is known of the answer to a task without solving it: closed forms, and the references of scenes, by name.

Each is a function of the request alone, whose last load counts; none of them knows what a submission has found.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from studies.ask.request import Request
from studies.scenes.benchmarks import shallow_cap
from studies.scenes.benchmarks.pagano import E_T, cross_plies
from studies.scenes.benchmarks.sze import circular_arc
from studies.scenes.closed_forms.contact import flattened_ring, plate_contact, strip_contact
from studies.scenes.closed_forms.elasticity import middle_deflection
from studies.scenes.closed_forms.marguerre_cap import classical_pressure
from studies.scenes.complete import STEP_KEYS, closest
from studies.scenes.contact.ring import RADIUS
from studies.scenes.faces.face_patch import SIDE

Exact = Callable[[Request, str], float]  # of a quantity by its name


def _load(request: Request) -> float:
    return request.numbers("load_fraction")[-1]


def _arc(request: Request, quantity: str) -> float:
    """Shortening [mm] of the strip that is bent into an arc."""
    return circular_arc(_load(request))[0]


def _plies(request: Request, quantity: str) -> float:
    """100 E_T w/(q0 h S^4), h = q0 = 1, from the equations of elasticity of each ply."""
    S, plies = request.number("S"), cross_plies(request.number("E_ratio"))
    return 100 * E_T * middle_deflection(plies, S, request.number("aspect") * S, 1.0) / S**4


def _plate(request: Request, quantity: str) -> float:
    """Radius of the disc of contact over that of the plate."""
    return plate_contact(64 * _load(request))[0]


def _ring(request: Request, quantity: str) -> float:
    """P R^2/(E I) of the inextensible ring."""
    return flattened_ring(1 - request.numbers("delta_mm")[-1] / RADIUS)[0]


def _cap(request: Request, quantity: str) -> float:
    """First limit point over the classical pressure."""
    lam = request.number("shallowness")
    h = shallow_cap.thickness(lam)
    snap, _ = shallow_cap.shallow_cap(lam).snap(4 * h)
    return snap / classical_pressure(shallow_cap.E, shallow_cap.NU, shallow_cap.RADIUS, h)


def _strip(request: Request, quantity: str) -> float:
    """Force on half of the strip over D g/a^3."""
    return strip_contact(24 * _load(request), request.number("lam_over_a")).half_force


def _coulomb(request: Request, quantity: str) -> float:
    """mu N [N] with N = p A: what friction is at the most."""
    return request.number("mu") * request.numbers("pressure_MPa")[-1] * SIDE**2


def _springs(request: Request, quantity: str) -> float:
    """p/epsilon [mm]: the mean penetration, by equilibrium, which the largest is not below."""
    return request.numbers("pressure_MPa")[-1] / request.number("epsilon")


def _of_scene(request: Request, quantity: str) -> float:
    """The least uncertain reference of the scene at the last load; NaN where there is none."""
    at = {key: value[-1] if isinstance(value, tuple) else value for key, value in request.settings.items()}
    there = {**request.settings, "measure": request.measure, **{key: at[key] for key in STEP_KEYS if key in at}}
    references = closest(request.scene, there, (quantity,))
    return references[quantity].value if references else math.nan


EXACT: Mapping[str, Exact] = {
    "the circular arc": _arc,
    "linear elasticity of the plies": _plies,
    "Kirchhoff's plate": _plate,
    "the elastica": _ring,
    "the shallow-shell equations": _cap,
    "Timoshenko's strip": _strip,
    "Coulomb's law": _coulomb,
    "pressure over epsilon": _springs,
    "the reference of the scene": _of_scene,
}
