"""Claims about contact algorithms, penalties, and optimisers that call an answer solved."""

from __future__ import annotations

import math

import pandas as pd

from studies.analysis.claims.record import CAMPAIGN, Claims, Verdict, always, banded, counted, values_of

claim = Claims("contact")
BOOKS, MANUALS = "textbooks of optimisation", "manuals of codes with penalties"
COUNTER = "published problems of small size, most of them known counterexamples"
WALLS, CONVEX = "beams, plates and tyres with stiff and soft walls", "linearised contact problems, judged to 1e-8"
TESTED = "all contact scenes, measures and meshes put to two algorithms"
PAPER_EPSILON = 1e4  # MPa/mm
ILL = 100.0  # times the condition: two digits
SLOWER = 2.0  # times the seconds
WITHIN = 0.01  # error of the force


@claim(
    "ten-e-over-h",
    "A penalty must be 10 to 100 E/h to be accurate to 1 %.",
    MANUALS,
    WALLS,
    "footprint solve tyre --out tyre --contact regularised --set epsilon=106",
)
def _penalty(epsilon_laws: pd.DataFrame) -> Verdict | None:
    own = epsilon_laws["error_at_wall"].abs()
    text = f"ε = E/h changes the force of {len(own)} problems by {own.min():.0e} to {own.max():.1e}"
    return banded((float(own.min()), float(own.max())), (WITHIN, math.inf), "error of the force", text, len(own))


@claim("ill-conditioned", "A penalty that is accurate to 1 % makes the matrix ill-conditioned.", BOOKS, WALLS, CAMPAIGN)
def _ill(epsilon_laws: pd.DataFrame) -> Verdict | None:
    own = epsilon_laws["growth_at_wall"]
    text = (
        f"at E/h, which is as accurate, the condition grows by factors of {own.min():.2g} to {own.max():.2g}, at ten "
    )
    text += f"times that by up to {epsilon_laws['growth_at_ten'].max():.2g}"
    return banded((float(own.min()), float(own.max())), (ILL, math.inf), "growth of the condition", text, len(own))


@claim(
    "paper-epsilon",
    "ε = 10^4 MPa/mm is the right regularisation.",
    "the paper of the tyre",
    WALLS,
    "footprint solve tyre --out tyre --contact regularised",
)
def _paper(epsilon_laws: pd.DataFrame) -> Verdict | None:
    own = PAPER_EPSILON / epsilon_laws["wall"]
    fine = int((epsilon_laws["error_at_wall"].abs() <= WITHIN).sum())
    text = f"it is {own.min():.0f} to {own.max():,.0f} times E/h of {len(own)} walls, on {fine} of which "
    text += f"E/h itself is within {WITHIN:.0%}"
    return banded((float(own.min()), float(own.max())), (1, 100), "times E/h", text, len(own))


def _claims(false_success: pd.DataFrame, contender: str, rest: str) -> Verdict | None:
    own = false_success[false_success["contender"] == contender]
    if own.empty:
        return None
    row = own.iloc[0]
    text = f"{row['false']} of {row['claimed']} answers called solved are refused by the judge{rest.format(**row)}"
    return counted(int(row["claimed"] - row["false"]), int(row["claimed"]), text)


@claim(
    "osqp-solved",
    "OSQP solves a contact problem at its defaults.",
    "osqp/osqp#270, RobotLocomotion/drake#16887",
    CONVEX,
    CAMPAIGN,
)
def _osqp(false_success: pd.DataFrame) -> Verdict | None:
    return _claims(false_success, "osqp alone, defaults", " (errors of up to {largest_error:.1g})")


@claim(
    "osqp-polished",
    "With a tolerance of 1e-8 and polishing OSQP's answers are right.",
    "osqp/osqp#273",
    CONVEX,
    CAMPAIGN,
)
def _polished(false_success: pd.DataFrame) -> Verdict | None:
    return _claims(false_success, "osqp alone, 1e-8 and polish", " (errors of up to {largest_error:.1g})")


@claim("interior-point", "Interior points at 1e-8 satisfy the contact conditions to 1e-8.", BOOKS, CONVEX, CAMPAIGN)
def _interior(false_success: pd.DataFrame) -> Verdict | None:
    return _claims(false_success, "clarabel alone, 1e-8", " (errors of up to {largest_error:.1g})")


@claim(
    "no-cycles",
    "Active sets do not cycle.",
    BOOKS,
    COUNTER,
    CAMPAIGN,
)
def _cycling(cycles: pd.DataFrame) -> Verdict | None:
    own = int((cycles["plain_period"] > 0).sum())
    return always(own, len(cycles), f"the textbook's set cycles on {own} of {len(cycles)} published problems")


@claim(
    "any-start",
    "A semismooth Newton method converges from any start.",
    "papers on contact",
    COUNTER,
    CAMPAIGN,
)
def _any_start(cycles: pd.DataFrame) -> Verdict | None:
    caught = int(cycles["semismooth"].astype(str).str.contains("cycle").sum())
    text = f"on {caught} of {len(cycles)} published problems it converges only because cycles are detected"
    return always(caught, len(cycles), text)


@claim("one-set", "All exact algorithms find the same contact set.", "taken for granted", "the paper's tyre", CAMPAIGN)
def _one_set(statement_values: pd.DataFrame) -> Verdict | None:
    own = values_of(statement_values, "algorithms-agree")
    if not own:
        return None
    text = f"{own['agree']:.0f} of {own['of']:.0f} solves have one contact set; forces differ by {own['off']:.0e}"
    return counted(int(own["agree"]), int(own["of"]), text)


@claim(
    "units",
    "Whether contact converges depends on the system of units.",
    "Dhondtguido/CalculiX#162",
    "clamped panels pressed by a plane or a ball",
    CAMPAIGN,
)
def _units(statement_values: pd.DataFrame) -> Verdict | None:
    own = values_of(statement_values, "units")
    if not own:
        return None
    changed = int(own["broken"])
    text = f"lengths a million times larger or smaller change {changed} of {own['pairs']:.0f} problems beyond rounding"
    return counted(changed, int(own["pairs"]), text)


@claim(
    "linear-solver",
    "The answer depends on the linear solver.",
    "Dhondtguido/CalculiX#64",
    "requests drawn at random",
    "footprint run fuzz",
)
def _linear_solver(statement_values: pd.DataFrame) -> Verdict | None:
    own = values_of(statement_values, "another-solver")
    if not own:
        return None
    text = f"{own['broken']:.0f} of {own['cases']:.0f} random requests differ for no computed reason"
    return counted(int(own["broken"]), int(own["cases"]), text)


@claim(
    "pressure-sum",
    "Nodal pressures times nodal areas add up to the force.",
    "OpenRadioss/OpenRadioss#5115",
    "middle surface, lumped coupling, 0.1 %",
    CAMPAIGN,
)
def _sums(statement_values: pd.DataFrame) -> Verdict | None:
    own = values_of(statement_values, "pressure-sum")
    if not own:
        return None
    text = f"to {own['off']:.2%} on the tyre at {own['delta']:g} mm"
    return banded((own["off"], own["off"]), (0, 0.001), "difference of forces", text, 1)


def _solved(outcomes: pd.DataFrame, name: str) -> Verdict | None:
    """On how many of the problems that another algorithm solves it converges."""
    own = outcomes[(outcomes["axis"] == "contact") & (outcomes["name"] == name) & outcomes["scene"].isna()]
    if own.empty:
        return None
    row = own.iloc[0]
    of = int(row["solved"] + row["failed"] + row["refused"])
    text = f"solves {row['solved']} of {of} problems, fails on {row['failed']} and refuses {row['refused']}"
    return counted(int(row["solved"]), of, text)


@claim(
    "trial-and-error", "Trial and error is enough to find the contact set.", "the paper of the tyre", TESTED, CAMPAIGN
)
def _trial(outcomes: pd.DataFrame) -> Verdict | None:
    return _solved(outcomes, "trial-and-error")


@claim("qp-newton", "A quadratic program in each Newton step serves any contact problem.", "papers", TESTED, CAMPAIGN)
def _qp(outcomes: pd.DataFrame) -> Verdict | None:
    return _solved(outcomes, "qp")


@claim("semismooth-all", "A semismooth Newton method solves whatever any algorithm solves.", "papers", TESTED, CAMPAIGN)
def _semismooth(outcomes: pd.DataFrame) -> Verdict | None:
    return _solved(outcomes, "semismooth")


@claim(
    "qp-slow",
    "Quadratic programs are much slower than active sets.",
    "common opinion",
    "problems that both solve; 95 % interval",
    CAMPAIGN,
    machine=True,
)
def _slow(contact_summary: pd.DataFrame) -> Verdict | None:
    own = contact_summary[(contact_summary["algorithm"] == "qp") & contact_summary["seconds_ratio"].notna()]
    if own.empty or pd.isna(own["seconds_low"].iloc[0]):
        return None
    row = own.iloc[0]
    low, high = float(row["seconds_low"]), float(row["seconds_high"])
    text = f"{row['seconds_ratio']:.2f} [{low:.2f}, {high:.2f}] times the seconds of `semismooth` in the median"
    return banded((low, high), (SLOWER, math.inf), "ratio of seconds", text, int(row["both"]))


claim.untested(
    "line-search", "A line search helps contact to converge.", "idaholab/moose#12388", "no algorithm here has one"
)
claim.untested(
    "barriers",
    "A barrier of vanishing thickness gives the contact problem.",
    "ipc-toolkit#41",
    "no campaign lets a thickness vanish",
)
claim.untested("mortar", "Mortar forces balance on curved faces.", "idaholab/moose#33657", "needs two bodies")
