"""Random requests of all scenes, and one law each, drawn from those that apply to what was asked.

The same answer by another algorithm, Newton iteration, linear solver, number of load steps; by a part of a tyre and the
whole; in other units. Derivatives of the converged problem are always compared with differences.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from contact.parameters import STIFFNESS
from studies.ask.request import Request, text_of
from studies.ask.scene import has_contact, models_of
from studies.ask.settings import MU, SLIDING, configured, rubbing, settings_of
from studies.fuzz import state_laws
from studies.fuzz.attempt import CONVERGED, Asked, Attempt, Broken, Passed, attempt, hardness, quiet
from studies.fuzz.comparing import AGREES, ALIKE, MARGIN, TOLERANCE, Answer, compared, error_of, unstable
from studies.fuzz.values import generator
from studies.scenes import SCENES
from studies.scenes.friction_readings import FORCES
from studies.solving.disagreement import ASYMMETRIES, BEYOND, LOAD_STEPS, SYMMETRY, UNSTABLE, Facts, why
from studies.solving.result import Result

EXACT = ("semismooth", "lcp", "qp", "augmented-lagrangian", "trial-and-error")
OFTEN = {"another algorithm": 2, "part = whole": 4, "units": 2}  # as often as a law that is not named here
LOOSE, TIGHT = 1e-6, 1e-10  # tolerance beyond which a state is solved on before it is compared, and to which one
FINER = (4, 12)  # times as many load steps, in which one answer is looked for
FAINT = "1e-10"  # a coefficient of friction next to none
UNITS, NEARBY = 9.0, 0.3  # powers of ten of a unit of the panel; where a length is forgotten both ways still converge
PLAIN = ("crushed-ring-solid", "tyre-solid", "two-cylinders", "ironing")  # Newton, for they have no resultants
PARTS = {"tyre": ("half", "quarter", "mirror", "auto"), "tyre-solid": ("quarter", "auto")}
PRODUCTS = {"_mm": (1, 0), "_MPa": (0, 1), "_N": (2, 1)}  # powers of length and of stress, by how a name ends
SCALED = {"tyre": 2.0, "tyre-solid": 2.0}  # factor of lengths and of stresses, up and down, within their ranges


def check(seed: int, asked: Asked) -> Passed:
    """Solve, and hold the result against the law of the number; raises Broken."""
    one = attempt(asked, seed)
    if one.kind != CONVERGED:
        return Passed(one.word, said=one.reason, hard=hardness(one.result))
    state_laws.check(one, _answer(one), seed)
    laws = _laws(asked)
    if not laws:
        return Passed(one.word, hard=hardness(one.result))
    # a draw that stays the same where other laws come or go
    law = max(laws, key=lambda name: generator(seed, f"law: {name}").random() ** (1 / OFTEN.get(name, 1)))
    try:
        outcome = laws[law](one, seed)
    except _NotComparedError as error:
        outcome = str(error)
    return Passed(one.word, law, outcome, hardness(one.result))


def _laws(asked: Asked) -> dict[str, Callable[[Attempt, int], str]]:
    """Those that apply, by name."""
    laws: dict[str, Callable[[Attempt, int], str]] = {}
    if has_contact(SCENES[asked.scene]):
        laws["another algorithm"] = _algorithms
    if float(asked.settings.get(MU.key, 0)) > 0:
        laws["friction fades"] = _fades
    if asked.scene not in PLAIN:
        laws["the other newton"] = _newton
    laws["another solver"] = _solver
    if asked.settings.get("until") != "limit":  # of which every step size finds another point
        laws["more steps"] = _steps
    if asked.scene in PARTS and asked.options.get("model", "auto") in PARTS[asked.scene]:
        laws["part = whole"] = _whole
    if asked.scene == "panel":
        laws["units"] = _panel_units
    if asked.scene in SCALED:
        laws["units"] = _scaled
    return laws


class _NotComparedError(Exception):
    """The other way of solving has no answer; one line."""


def _solved(asked: Asked, seed: int) -> Attempt:
    """Another request, solved; raises _NotComparedError where it does not converge."""
    other = attempt(asked, seed)
    if other.kind != CONVERGED:
        raise _NotComparedError(f"not compared, {other.word}: {other.reason}")
    return other


# --- the same problem, solved in another way --------------------------------------------------------------------------


def _algorithms(one: Attempt, seed: int) -> str:
    """By another algorithm, with the same epsilon and its own parameters."""
    contact, settings = one.asked.options.get("contact", Request.contact), dict(one.asked.settings)
    finite = np.isfinite(one.found.request.number("epsilon"))  # of which a multiplier that is exact knows nothing
    others = [name for name in EXACT if name != contact and not (finite and name == "augmented-lagrangian")]
    rng = generator(seed, "other algorithm")
    other = str(rng.choice(others)) if contact == "semismooth" or rng.random() < 0.5 else "semismooth"
    for setting in settings_of(contact):
        settings.pop(setting.key, None)
    settings["epsilon"] = text_of(one.found.request.number("epsilon"))
    return _same(one, replace(one.asked.with_options(contact=other), settings=settings), seed)


def _fades(one: Attempt, seed: int) -> str:
    """Next to no friction does what none does."""
    slides = {setting.key for setting in SLIDING}
    own = {setting.key for setting in settings_of(one.found.request.contact)}  # of which friction has not all
    still = {key: value for key, value in one.asked.settings.items() if key not in slides | own | {MU.key}}
    asked, model = replace(one.asked, settings=still), one.found.request.model
    if model in models_of(SCENES[asked.scene]):
        asked = asked.with_options(model=model)
    return _same(_solved(asked, seed), asked.with_settings(**{MU.key: FAINT}), seed)


def _newton(one: Attempt, seed: int) -> str:
    other = "plain" if one.found.request.newton == "mixed" else "mixed"
    return _same(one, one.asked.with_options(newton=other), seed)


def _solver(one: Attempt, seed: int) -> str:
    other = "multifrontal" if one.found.request.choice("solver") == "splu" else "splu"
    return _same(one, one.asked.with_settings(solver=other), seed)


def _steps(one: Attempt, seed: int) -> str:
    return _same(one, one.asked.with_options(steps=str(one.found.request.steps + 1)), seed)


def _same(one: Attempt, asked: Asked, seed: int) -> str:
    """What a comparison of last states says; raises Broken where nothing explains the difference."""
    other = _solved(asked, seed)
    difference = compared(_answer(one), _answer(other))
    if not difference:
        raise Broken("one answer", f"unlike {asked.command}")
    return difference


def _answer(one: Attempt) -> Answer:
    """The last state."""
    end = one.found.end
    assert end is not None
    request, result = one.found.request, one.found
    algorithm = configured(request.contact, request.settings)
    loose = request.number("tolerance") > LOOSE
    tight = configured(request.contact, {**request.settings, "tolerance": TIGHT}) if loose else None
    return Answer(end.problem, end.point.solution, algorithm, result.ways, not result.on_the_way, tight)


# --- another problem with the same answer -----------------------------------------------------------------------------


def _whole(one: Attempt, seed: int) -> str:
    """A part of the tyre and all of it; resultants of friction are of the part alone."""
    return Reported(left=FORCES).compare(one, one.asked.with_options(model="full"), seed)


def _panel_units(one: Attempt, seed: int) -> str:
    """The panel reports in mm, N and MPa whatever its units; epsilon and its like are in those of the problem."""
    rng, request = generator(seed, "units"), one.found.request
    span = float(rng.choice([UNITS, NEARBY]))
    length, stress = (float(f"{10.0 ** rng.uniform(-span, span):.4g}") for _ in range(2))
    known = {setting.key: setting for setting in (*SCENES["panel"].settings, *settings_of(request.contact))}
    before = {key: request.number(key) for key in ("length_unit", "stress_unit")}
    units = {"length_unit": text_of(length), "stress_unit": text_of(stress)}
    factor = stress / before["stress_unit"] / (length / before["length_unit"])
    stiff = {key: factor * request.number(key) for key in known if known[key].unit == STIFFNESS}
    asked = one.asked.with_settings(**units, **{key: text_of(value) for key, value in stiff.items()})
    return Reported().compare(one, asked, seed)


def _scaled(one: Attempt, seed: int) -> str:
    """All lengths and all stresses of a tyre by a factor."""
    rng, request = generator(seed, "units"), one.found.request
    length, stress = (float(SCALED[request.scene] ** rng.uniform(-1, 1)) for _ in range(2))
    settings = dict(one.asked.settings)
    for key, value in request.settings.items():
        power = next((powers for end, powers in PRODUCTS.items() if key.endswith(end)), None)
        power = (-1, 1) if key == "epsilon" else power
        if power is None or isinstance(value, str):
            continue
        factor = length ** power[0] * stress ** power[1]
        settings[key] = text_of(tuple(factor * v for v in value) if isinstance(value, tuple) else factor * value)
    return Reported(length, stress).compare(one, replace(one.asked, settings=settings), seed)


@dataclass(frozen=True)
class Reported:
    """Forces and pressures that two solves report, which are continuous in the state.

    length, stress: the units of the other solve.  left: quantities that are not compared.
    """

    length: float = 1.0
    stress: float = 1.0
    left: Collection[str] = ()

    def compare(self, one: Attempt, asked: Asked, seed: int) -> str:
        """What a comparison with another request says; raises Broken where nothing explains the difference."""
        other = _solved(asked, seed)
        worst, apart = self._worst(one, other)
        if apart <= ALIKE:
            return AGREES
        answers = [_answer(each) for each in (one, other)]
        with quiet():
            errors = [error_of(each) for each in answers]
            counts = [unstable(each) for each in answers]
        if apart <= MARGIN * max(errors):
            return f"{TOLERANCE}: {worst} apart by {apart:.1e}"
        if any(counts):
            return f"{UNSTABLE}: {counts[0]} and {counts[1]} eigenvalues are negative, {worst} apart by {apart:.1e}"
        facts = [_facts(each.found) for each in (one, other)]
        cause = why(*facts)
        many = self._many_enough(one, other, seed) if cause in (LOAD_STEPS, BEYOND) else 0
        if many:  # two answers of large steps; what smaller ones lead to is one
            return f"{LOAD_STEPS}: {worst} apart by {apart:.1e}, one answer in {many} times as many"
        if cause == SYMMETRY:
            return f"{SYMMETRY}: {facts[0].model} and {facts[1].model} model, {worst} apart by {apart:.1e}"
        raise Broken("one answer", f"{worst} apart by {apart:.1e}, unlike {asked.command}")

    def _many_enough(self, one: Attempt, other: Attempt, seed: int) -> int:
        """How many times as many load steps lead both to one answer, 0 where none of FINER does."""
        for many in FINER:
            first, second = (
                attempt(each.asked.with_options(steps=str(many * each.found.request.steps)), seed)
                for each in (one, other)
            )
            if first.kind == second.kind == CONVERGED and self._worst(first, second)[1] <= ALIKE:
                return many
        return 0

    def _worst(self, one: Attempt, other: Attempt) -> tuple[str, float]:
        """The quantity that differs most, and by how much, relative."""
        mine, theirs = (each.found.loads[-1].quantities for each in (one, other))
        compared = [key for key in mine if key.endswith(("_N", "_MPa")) and key not in self.left]
        return max(((key, self._apart(mine, theirs, key)) for key in compared), key=lambda item: item[1])

    def _apart(self, mine: Mapping[str, float], theirs: Mapping[str, float], key: str) -> float:
        """Relative; of the resultant of friction, which may cancel or be next to none, over the largest force."""
        power = next(powers for end, powers in PRODUCTS.items() if key.endswith(end))
        one, other = mine[key], theirs[key] / (self.length ** power[0] * self.stress ** power[1])
        forces = [abs(value) for name, value in mine.items() if name.endswith("_N") and np.isfinite(value)]
        most = max(forces) if key == "friction_N" else 0.0
        size = max(abs(one), abs(other), most)
        return float(np.abs(one - other) / size) if 0 < size < np.inf else 0.0


def _facts(result: Result) -> Facts:
    """What may explain why another answer differs."""
    quantities = result.loads[-1].quantities
    return Facts(
        friction=rubbing(result.request.settings),
        steps=result.ways,
        stable=True,
        model=result.request.model,
        asymmetry=tuple(float(quantities.get(f"{name}_asymmetry", 0.0)) for name in ASYMMETRIES),
    )
