"""What users of other solvers ask in public, and what a reader of the report will: the sentences that answer it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import pandas as pd

ASK_COLUMNS = ("question", "threads", "answers", "command", "missing", "answered")
READER_COLUMNS = ("question", "answers", "page", "answered")


@dataclass(frozen=True)
class Ask:
    """A question, the public threads that ask it, the statements that answer it, and what is missing."""

    question: str
    threads: str
    answers: tuple[str, ...] = ()
    command: str = ""
    missing: str = ""


ASKS = (
    Ask(
        "Which shell formulation follows a deflection of ten thicknesses? Two codes differ.",
        "KratosMultiphysics/Kratos#13833",
        ("measures-large",),
        "footprint solve cantilever --measure sanders --out DIR",
    ),
    Ask(
        "Why does contact converge in one system of units and not in another?",
        "Dhondtguido/CalculiX#162, idaholab/moose#11601, idaholab/moose#30020",
        ("units",),
        "footprint solve strip-contact --out DIR",
    ),
    Ask(
        "How do I choose the penalty of normal contact?",
        "idaholab/moose#32856",
        ("epsilon-range",),
        "footprint solve tyre --contact regularised --set epsilon=1e4 --out DIR",
        "a study of the tangential parameter alone",
    ),
    Ask(
        "How sensitive is an answer to the regularisation of Coulomb's law?",
        "idaholab/moose#33356, idaholab/moose#33358, idaholab/moose#6524",
        ("friction-regularised", "friction-greco"),
        "footprint solve tyre --contact regularised --model full --set mu=0.5 --set drag_mm=2 --out DIR",
        "a range of the parameter: one stiffness of springs is compared with the exact law",
    ),
    Ask(
        "Which tolerance in the tangential equation?",
        "pmgbergen/porepy#957",
        missing="a study of it: stick and slip are states here, that are met exactly",
    ),
    Ask(
        "Which change of the contact area is small enough to stop?",
        "GEOS-DEV/GEOS#3379",
        ("settling", "algorithms-agree"),
        "footprint solve tyre --contact semismooth --set settle=1 --out DIR",
    ),
    Ask(
        "The residual stays just above the tolerance: is the answer wrong?",
        "siconos/siconos#214",
        ("false-by-contender",),
        "footprint run standard",
    ),
    Ask(
        'The solver says "solved": is it?',
        "osqp/osqp#273, osqp/osqp#270, RobotLocomotion/drake#16887",
        ("false-solved",),
        "footprint run standard",
    ),
    Ask(
        "Can the linear solver alone change a displacement by orders of magnitude?",
        "Dhondtguido/CalculiX#64",
        ("another-solver",),
        "footprint fuzz --cases 100",
    ),
    Ask(
        "Do two contact algorithms give the same answer?",
        "KratosMultiphysics/Kratos#11713",
        ("another-algorithm", "algorithms-agree"),
        "footprint solve tyre --contact lcp --out DIR",
        "near incompressibility in a solid, which is what was asked there",
    ),
    Ask(
        "Why does a pinched hemisphere give half of the displacement?",
        "KratosMultiphysics/Kratos#12135, meyer-nils/torch-fem#57",
        ("hemisphere",),
        "footprint solve hemisphere --mesh 32x32 --out DIR",
    ),
    Ask(
        "How do I get the contact pressure of a roller on a rigid plane, in Python?",
        "adtzlr/felupe#800, adtzlr/felupe#919, adtzlr/felupe#1067",
        ("pressure-order", "force-known"),
        "footprint solve tyre --set delta_mm=20 --out DIR",
    ),
    Ask(
        "How do I put a pressure on a soft shell, which turns with it?",
        "sfepy/sfepy#708, sfepy/sfepy#518, kinnala/scikit-fem#642",
        ("tyre-mesh-and-load",),
        "footprint solve tyre --set load=follower --set pressure_area=face --out DIR",
    ),
    Ask(
        "Contact pressures are wrong by the nodal area: do they add up?",
        "OpenRadioss/OpenRadioss#5115",
        ("pressure-sum",),
        "footprint solve tyre --set delta_mm=20 --out DIR",
    ),
    Ask(
        "Is there a contact test with an analytic answer beside it?",
        "FrontISTR merge requests 599 and 668",
        ("closed-forms", "pressure-order"),
        "footprint solve ring --set lines=rim --out DIR",
        "Hertz's problem of two solids",
    ),
    Ask(
        "How do rigid bodies go with shells?",
        "Dhondtguido/CalculiX#134",
        missing="rigid bodies that are tied to a shell; obstacles are rigid, and fixed or moved",
    ),
)
READERS = (  # what a reader asks, the statements that answer, and the page of the details
    ("Which strain measure do I need for 20 mm of tyre at 5 %?", ("tyre-measure",), "measures"),
    ("What does a better grid save?", ("grids-of-the-tyre",), "cost"),
    ("Which contact algorithm, and when not?", ("which-algorithm",), "algorithms"),
    ("How far is the force of the tyre known?", ("force-known",), "cost"),
    ('Does "solved" of OSQP mean solved?', ("false-solved",), "algorithms"),
    ("On which scenes does trial-and-error not converge?", ("trial-and-error-ends",), "algorithms"),
    ("Is the paper's table reproduced?", ("printed-table",), "tyre"),
    ("What does 1 % cost?", ("one-per-cent",), "index"),
    ("What is the exact problem of a scene, and where is a picture of it?", ("scenes",), "gallery"),
    ("How sure is advice?", ("advice",), "cost"),
)


def asks(said: Collection[str]) -> pd.DataFrame:
    """ASK_COLUMNS, a row a question; answers: the statements of ``said`` that are there, by their names."""
    rows = [(a.question, a.threads, _there(a.answers, said), a.command, a.missing) for a in ASKS]
    table = pd.DataFrame(rows, columns=list(ASK_COLUMNS[:-1]))
    return table.assign(answered=table["answers"] != "")


def readers(said: Collection[str]) -> pd.DataFrame:
    """READER_COLUMNS, a row a question of a reader."""
    rows = [(question, _there(names, said), page) for question, names, page in READERS]
    table = pd.DataFrame(rows, columns=list(READER_COLUMNS[:-1]))
    return table.assign(answered=table["answers"] != "")


def _there(names: tuple[str, ...], said: Collection[str]) -> str:
    return ", ".join(name for name in names if name in said)
