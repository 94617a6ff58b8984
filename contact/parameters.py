"""What a parameter of a contact algorithm is: key, meaning, unit and range, declared beside the algorithm that has it.

Its default is that of the field with its key. Whoever offers the parameters to a user translates them; no scene, no
command line and no text of a setting may enter here.
"""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Parameter:
    """A parameter by the name of its field.

    kind: "float", "int" or "choice", one of ``choices``.  low, high: range of a number, the bounds included unless
    ``open_low``; infinity only where ``infinite``.  frictionless: it means something without friction alone.
    """

    key: str
    meaning: str
    unit: str = ""
    kind: str = "float"
    low: float = -math.inf
    high: float = math.inf
    open_low: bool = False
    infinite: bool = False
    choices: tuple[str, ...] = ()
    frictionless: bool = False


STIFFNESS = "MPa/mm"  # the unit of all that weighs pressure against gap

EPSILON = Parameter(
    "epsilon",
    "regularisation: pressure over penetration; inf enforces contact exactly",
    STIFFNESS,
    low=0,
    open_low=True,
    infinite=True,
)
TOLERANCE = Parameter(
    "tolerance", "residual of Newton's iteration, relative to the forces in balance", low=1e-14, high=1e-1
)
SOLVER = Parameter(
    "solver",
    "sparse direct solver; auto: multifrontal where there is an order of elimination; pardiso needs the extra mkl",
    kind="choice",
    choices=("auto", "multifrontal", "splu", "pardiso"),
)
SYSTEM = Parameter(
    "system",
    "linearised problem on the candidates whose state changes (condensed) or on all (full)",
    kind="choice",
    choices=("condensed", "full"),
    frictionless=True,
)
SHARED = (EPSILON, TOLERANCE, SOLVER)  # what every algorithm here has
