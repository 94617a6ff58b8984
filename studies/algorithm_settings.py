"""The parameters of Newton and of each contact algorithm as settings, which a scene has beside its own."""

from __future__ import annotations

import dataclasses

from contact.catalogue import ALGORITHMS
from contact.newton.step import RESIDUAL_TOLERANCE
from contact.solvers.lcp_pivoting import METHODS
from contact.solvers.qp_backends import BACKENDS
from studies.scene import Setting

TOLERANCE = Setting(
    "tolerance", RESIDUAL_TOLERANCE, "residual of Newton's iteration over the forces in balance", low=1e-14, high=1e-1
)
_MORE = (
    Setting("settle", None, "fraction of the set that may change before the next linearisation", low=0, high=1),
    Setting(
        "c", None, "weight of gap against pressure, first stiffness of the augmented Lagrangian", low=0, unit="MPa/mm"
    ),
    Setting("backend", None, "solver of the quadratic programmes", "choice", choices=tuple(BACKENDS)),
    Setting("eps", None, "tolerance of the quadratic programmes", low=1e-14, high=1),
    Setting("method", None, "solution of the linear complementarity problem", "choice", choices=tuple(METHODS)),
)
KEYS = tuple(setting.key for setting in _MORE)


def settings_of(contact: str) -> tuple[Setting, ...]:
    """Those of ``_MORE`` that the algorithm has, with its own defaults; none for an unknown name."""
    if contact not in ALGORITHMS:
        return ()
    algorithm = ALGORITHMS[contact]()
    return tuple(
        dataclasses.replace(setting, default=getattr(algorithm, setting.key), open_low=setting.key == "c")
        for setting in _MORE
        if hasattr(algorithm, setting.key)
    )
