"""A shell and a solid on meshes that get finer: their limits, how well they are known, and what an answer costs.

    error = shell's limit/judge - 1,   known to = what the finest meshes are off their limits, both bodies together

The judge is the closed form of elasticity where there is one, else the solid's limit; the other one stands beside it.
Limits are Richardson's with the formal order of the body, from its two finest meshes. Costs are those of the coarsest
mesh within :data:`GOOD` of the body's own limit: building, assembling and solving, in seconds of processor time.

A new case is a pair of functions and one entry here; it comes into the table, its page and the advice by itself.
"""

import math
import statistics
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import pandas as pd

from studies.experiments.shell_limits import bending, bodies, pressed
from studies.solving.refinement.richardson import correction

GOOD = 0.005  # of a mesh whose cost is stated
REPEATS, LONG = 3, 1.0  # of a solution, unless it takes longer [s]
COLUMNS = (
    *("case", "scene", "quantity", "thickness", "ratio", "variant", "exact", "error", "known_to"),
    *("solid_against_exact", "shell_unknowns", "shell_seconds", "solid_unknowns", "solid_seconds", "fails"),
)


@dataclass(frozen=True)
class Case:
    """One kind of scene over its thickness; ``ratio`` is h over what ``thickness`` says.

    shell(ratio, n, variant), solid(ratio, n): the bodies with n elements along, their answers by quantity.
    exact(ratio): of elasticity, where a closed form exists.  orders: of the shell and of the solid, formal.
    fails: which part of the shell's kinematics the error comes from.
    """

    name: str
    scene: str
    thickness: str
    ratios: Sequence[float]
    shell: Callable[[float, int, bodies.Variant], bodies.Answer]
    solid: Callable[[float, int], bodies.Answer]
    shell_meshes: Sequence[int]
    solid_meshes: Sequence[int]
    fails: str
    exact: Callable[[float], Mapping[str, float]] | None = None
    orders: tuple[float, float] = (2.0, 4.0)
    variants: tuple[bodies.Variant, ...] = ()


@dataclass
class Ladder:
    """Answers of one body on its meshes, coarse to fine; each is solved once, and again only to be timed."""

    solve: Callable[[int], bodies.Answer]
    meshes: Sequence[int]
    order: float
    answers: list[bodies.Answer] = field(init=False)
    seconds: list[list[float]] = field(init=False)  # of a mesh as often as it was solved

    def __post_init__(self) -> None:
        answers, seconds = zip(*map(self._timed, self.meshes), strict=True)
        self.answers, self.seconds = list(answers), [[spent] for spent in seconds]

    def _timed(self, n: int) -> tuple[bodies.Answer, float]:
        start = time.process_time()
        answer = self.solve(n)
        return answer, time.process_time() - start

    def limit(self, quantity: str) -> float:
        """Richardson's of the two finest meshes."""
        values = [answer.values[quantity] for answer in self.answers[-2:]]
        sizes = self.meshes[-1], self.meshes[-2]  # 1/n, both times the product of the numbers
        return values[-1] + correction(sizes, values, self.order)

    def left(self, quantity: str) -> float:
        """What the finest mesh is off the limit, relative."""
        return abs(self.answers[-1].values[quantity] / self.limit(quantity) - 1)

    def cost(self, quantity: str) -> tuple[float, float]:
        """Unknowns and median seconds of the coarsest mesh that is good, and all finer ones too; NaN where none is."""
        limit = self.limit(quantity)
        good = [abs(answer.values[quantity] / limit - 1) <= GOOD for answer in self.answers]
        first = next((i for i in range(len(good)) if all(good[i:])), None)
        if first is None:
            return math.nan, math.nan
        spent = self.seconds[first]
        while spent[0] < LONG and len(spent) < REPEATS:  # but for the quantities before, of the same mesh
            spent.append(self._timed(self.meshes[first])[1])
        return self.answers[first].unknowns, statistics.median(spent)


def rows_of(case: Case) -> Iterator[dict[str, Any]]:
    """A row of COLUMNS for every ratio, quantity and variant."""
    for ratio in case.ratios:
        solid = Ladder(partial(case.solid, ratio), case.solid_meshes, case.orders[1])
        known = case.exact(ratio) if case.exact else {}
        for variant in (bodies.USUAL, *case.variants):
            shell = Ladder(partial(_of_variant, case, ratio, variant), case.shell_meshes, case.orders[0])
            costed = variant.name.startswith((bodies.DEFAULT, bodies.OF_SURFACES))
            for quantity in shell.answers[0].values:
                yield {
                    **{"case": case.name, "scene": case.scene, "quantity": quantity, "thickness": case.thickness},
                    **{"ratio": ratio, "variant": variant.name, "fails": case.fails},
                    **_compared(shell, solid, quantity, known.get(quantity)),
                    **(_costs(shell, solid, quantity) if costed else {}),
                }


def _of_variant(case: Case, ratio: float, variant: bodies.Variant, n: int) -> bodies.Answer:
    return case.shell(ratio, n, variant)


def _compared(shell: Ladder, solid: Ladder, quantity: str, exact: float | None) -> dict[str, float]:
    limit, body = shell.limit(quantity), solid.limit(quantity)
    judge = body if exact is None else exact
    return {
        **{"exact": math.nan if exact is None else exact, "error": limit / judge - 1},
        "known_to": shell.left(quantity) + (solid.left(quantity) if exact is None else 0.0),
        "solid_against_exact": math.nan if exact is None else body / exact - 1,
    }


def _costs(shell: Ladder, solid: Ladder, quantity: str) -> dict[str, float]:
    names = ("shell_unknowns", "shell_seconds", "solid_unknowns", "solid_seconds")
    return dict(zip(names, (*shell.cost(quantity), *solid.cost(quantity)), strict=True))


THIN_TO_THICK = (0.001, 0.003, 0.01, 0.03, 0.1, 0.2, 0.35, 0.5)
FROM_A_HUNDREDTH = (0.01, 0.03, 0.1, 0.2, 0.35, 0.5)
LAWS: tuple[bodies.Variant, ...] = (bodies.NONSYMMETRIC, bodies.FULL_3D)
INSIDE: tuple[bodies.Variant, ...] = (bodies.THREE, bodies.FIVE)

CASES = (
    Case(
        *("inflated tube", "pressurised-cylinder", "h/R", THIN_TO_THICK),
        *(pressed.TUBE.shell, pressed.TUBE.solid, (1, 2, 4), (1, 2, 4, 8)),
        "the hoop strain u/r is convex through the wall, and the shell's is linear between the faces, on an area that "
        "does not vary; that its displacement lacks the 1/r is the smaller part",
        exact=pressed.TUBE.lame,
        variants=(*LAWS, bodies.MIDDLE, *INSIDE),
    ),
    Case(
        *("inflated sphere", "pressurised-sphere", "h/R", THIN_TO_THICK),
        *(pressed.BALL.shell, pressed.BALL.solid, (2, 4, 8, 16), (1, 2, 4, 8)),
        "as in the tube, in two directions",
        exact=pressed.BALL.lame,
        variants=(*LAWS, bodies.MIDDLE, *INSIDE),
    ),
    Case(
        *("inflated torus", "pressurised-torus", "h/R", FROM_A_HUNDREDTH),
        *(pressed.TORUS.shell, pressed.TORUS.solid, (8, 16, 32, 64, 128), (4, 8, 16, 24, 40)),
        "as in the tube; hoop and meridian forces nearly cancel in the growth, which enlarges what is missed",
        variants=(*LAWS, bodies.MIDDLE, *INSIDE),
    ),
    Case(
        *("inflated wall of a tyre", "tyre", "h/R", FROM_A_HUNDREDTH),
        *(pressed.TYRE.shell, pressed.TYRE.solid, (8, 16, 32, 64, 128), (4, 8, 16, 24, 40)),
        "as in the torus, the larger ν the more",
        variants=(*LAWS, bodies.MIDDLE, *INSIDE),
    ),
    Case(
        *("curved bar under moments", "", "h/R", THIN_TO_THICK[1:]),
        *(bending.bar_shell, bending.bar_solid, (2, 4, 8, 16), (4, 8, 16, 32, 64)),
        "fibres of unequal length stretch as a hyperbola through the wall; the shell's strain is linear through it",
        exact=bending.bar_exact,
        variants=(*LAWS, *INSIDE),
    ),
    Case(
        *("ring made oval", "", "h/R", THIN_TO_THICK[1:]),
        *(bending.oval_shell, bending.oval_solid, (8, 16, 32, 64, 128), (4, 8, 16, 32, 64)),
        "the shear of bending is a parabola through the wall, the shell's is constant, and stiffer by 6/5",
        exact=bending.oval_exact,
        variants=(*LAWS, bodies.REISSNER, bodies.MIDDLE, *INSIDE),
    ),
    Case(
        *("cantilever under an end force", "cantilever", "h/L", FROM_A_HUNDREDTH),
        *(bending.beam_shell, bending.beam_solid, (4, 8, 16, 32, 64), (4, 8, 16, 32)),
        "the parabola of the shear again; at the clamp the body has a layer that the shell lacks",
        variants=(bodies.FULL_3D, bodies.REISSNER, *INSIDE),
    ),
    Case(
        *("roof under its weight", "scordelis-lo", "h/R", FROM_A_HUNDREDTH),
        *(bending.roof_shell, bending.roof_solid, (4, 8, 16, 32), (4, 8, 16)),
        "the parabola of the shear, and layers at the free edge",
        variants=(bodies.REISSNER, *INSIDE),
    ),
    Case(
        *("cross-ply plate", "pagano", "h/a", (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.25)),
        *(bending.plate_shell, bending.plate_solid, (4, 8, 16, 32), (2, 4, 8)),
        "the shear strain jumps from ply to ply as the moduli do; the shell's is constant through all plies",
        exact=bending.plate_exact,
        variants=(bodies.FULL_3D, bodies.REISSNER, bodies.TWO_A_PLY, bodies.THREE_A_PLY),
    ),
    Case(
        *("crushed ring", "ring", "h/R", (0.03, 0.1, 0.2, 0.3, 0.42)),
        *(pressed.ring_shell, pressed.ring_solid, (8, 16, 32, 64), (8, 16, 32)),
        "the parabola of the shear for the most part; the rest is that of the curved bar, and the dent under the plate",
        variants=(bodies.REISSNER, *INSIDE),
    ),
    Case(
        *("strip on an obstacle", "strip-contact", "h/a", (0.03, 0.1, 0.2, 0.35, 0.5)),
        *(pressed.strip_shell, pressed.strip_solid, (16, 32, 64, 128), (8, 16, 32)),
        "the parabola of the shear, and the edge of the contact, where pressure squeezes the wall",
        variants=(bodies.REISSNER, *INSIDE),
    ),
    Case(
        *("pressed tyre", "tyre", "h/R", (0.03, 0.096, 0.2, 0.35)),
        *(pressed.tyre_shell, pressed.tyre_solid, (14, 28, 56, 84), (14, 28)),
        "the growth as that of the inflated wall; the force is mostly the pressure inside, which both carry alike",
        orders=(2.0, 2.0),
        variants=(bodies.MIDDLE, bodies.THREE),
    ),
)


def shell_limits(cases: tuple[Case, ...] = CASES) -> pd.DataFrame:
    """COLUMNS a row a case, thickness, quantity and variant."""
    rows = (row for case in cases for row in rows_of(case))
    return pd.DataFrame(rows, columns=list(COLUMNS))
