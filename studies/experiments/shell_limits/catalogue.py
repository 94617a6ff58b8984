"""The cases, one line each in the list, and the table over all of them.

A new case is a pair of functions and one entry here; it comes into the table, its page and the advice by itself.
"""

from __future__ import annotations

import pandas as pd

from studies.experiments.shell_limits import bending, contact, pressure
from studies.experiments.shell_limits.ladder import (
    COLUMNS,
    FULL_3D,
    MIDDLE,
    NONSYMMETRIC,
    REISSNER,
    Case,
    Variant,
    rows_of,
)

THIN_TO_THICK = (0.001, 0.003, 0.01, 0.03, 0.1, 0.2, 0.35, 0.5)
FROM_A_HUNDREDTH = (0.01, 0.03, 0.1, 0.2, 0.35, 0.5)
LAWS: tuple[Variant, ...] = (NONSYMMETRIC, FULL_3D)

CASES = (
    Case(
        *("inflated tube", "pressurised-cylinder", "h/R", THIN_TO_THICK),
        *(pressure.TUBE.shell, pressure.TUBE.solid, (1, 2, 4), (1, 2, 4, 8)),
        "the hoop strain u/r is convex through the wall, and the shell's is linear between the faces, on an area that "
        "does not vary; that its displacement lacks the 1/r is the smaller part",
        exact=pressure.TUBE.lame,
        straight=pressure.TUBE.straight,
        variants=(*LAWS, MIDDLE),
    ),
    Case(
        *("inflated sphere", "pressurised-sphere", "h/R", THIN_TO_THICK),
        *(pressure.BALL.shell, pressure.BALL.solid, (2, 4, 8, 16), (1, 2, 4, 8)),
        "as in the tube, in two directions",
        exact=pressure.BALL.lame,
        straight=pressure.BALL.straight,
        variants=(*LAWS, MIDDLE),
    ),
    Case(
        *("inflated torus", "pressurised-torus", "h/R", FROM_A_HUNDREDTH),
        *(pressure.TORUS.shell, pressure.TORUS.solid, (8, 16, 32, 64, 128), (4, 8, 16, 24, 40)),
        "as in the tube; hoop and meridian forces nearly cancel in the growth, which enlarges what is missed",
        straight=pressure.TORUS.straight,
        variants=(*LAWS, MIDDLE),
    ),
    Case(
        *("inflated wall of a tyre", "tyre", "h/R", FROM_A_HUNDREDTH),
        *(pressure.TYRE.shell, pressure.TYRE.solid, (8, 16, 32, 64, 128), (4, 8, 16, 24, 40)),
        "as in the torus, the larger ν the more",
        straight=pressure.TYRE.straight,
        variants=(*LAWS, MIDDLE),
    ),
    Case(
        *("curved bar under moments", "", "h/R", THIN_TO_THICK[1:]),
        *(bending.bar_shell, bending.bar_solid, (2, 4, 8, 16), (4, 8, 16, 32, 64)),
        "fibres of unequal length stretch as a hyperbola through the wall; the shell's strain is linear through it",
        exact=bending.bar_exact,
        variants=LAWS,
    ),
    Case(
        *("ring made oval", "", "h/R", THIN_TO_THICK[1:]),
        *(bending.oval_shell, bending.oval_solid, (8, 16, 32, 64, 128), (4, 8, 16, 32, 64)),
        "the shear of bending is a parabola through the wall, the shell's is constant, and stiffer by 6/5",
        exact=bending.oval_exact,
        variants=(*LAWS, REISSNER, MIDDLE),
    ),
    Case(
        *("cantilever under an end force", "cantilever", "h/L", FROM_A_HUNDREDTH),
        *(bending.beam_shell, bending.beam_solid, (4, 8, 16, 32, 64), (4, 8, 16, 32)),
        "the parabola of the shear again; at the clamp the body has a layer that the shell lacks",
        variants=(FULL_3D, REISSNER),
    ),
    Case(
        *("roof under its weight", "scordelis-lo", "h/R", FROM_A_HUNDREDTH),
        *(bending.roof_shell, bending.roof_solid, (4, 8, 16, 32), (4, 8, 16)),
        "the parabola of the shear, and layers at the free edge",
        variants=(REISSNER,),
    ),
    Case(
        *("cross-ply plate", "pagano", "h/a", (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.25)),
        *(bending.plate_shell, bending.plate_solid, (4, 8, 16, 32), (2, 4, 8)),
        "the shear strain jumps from ply to ply as the moduli do; the shell's is constant through all plies",
        exact=bending.plate_exact,
        variants=(FULL_3D, REISSNER),
    ),
    Case(
        *("crushed ring", "ring", "h/R", (0.03, 0.1, 0.2, 0.3, 0.42)),
        *(contact.ring_shell, contact.ring_solid, (8, 16, 32, 64), (8, 16, 32)),
        "the parabola of the shear for the most part; the rest is that of the curved bar, and the dent under the plate",
        variants=(REISSNER,),
    ),
    Case(
        *("strip on an obstacle", "strip-contact", "h/a", (0.03, 0.1, 0.2, 0.35, 0.5)),
        *(contact.strip_shell, contact.strip_solid, (16, 32, 64, 128), (8, 16, 32)),
        "the parabola of the shear, and the edge of the contact, where pressure squeezes the wall",
        variants=(REISSNER,),
    ),
    Case(
        *("pressed tyre", "tyre", "h/R", (0.03, 0.096, 0.2, 0.35)),
        *(contact.tyre_shell, contact.tyre_solid, (14, 28, 56, 84), (14, 28)),
        "the growth as that of the inflated wall; the force is mostly the pressure inside, which both carry alike",
        orders=(2.0, 2.0),
        variants=(MIDDLE,),
    ),
)


def shell_limits(cases: tuple[Case, ...] = CASES) -> pd.DataFrame:
    """COLUMNS of :mod:`.ladder`, a row a case, thickness, quantity and variant."""
    rows = (row for case in cases for row in rows_of(case))
    return pd.DataFrame(rows, columns=list(COLUMNS))
