"""Derivatives of answers: judged by solutions beside, by laws of physics, and with faults planted on purpose."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from contact.sensitivity import Change, Rates
from studies.ask.request import UsageError
from studies.cli import main
from studies.footprint import solve as solve_here
from studies.scenes.complete import complete
from studies.solving.derivatives import beside, gradient, sides, taylor
from studies.solving.derivatives.gradient import Derivative
from studies.solving.derivatives.sides import Passed, Side
from studies.solving.refinement import mesh_error
from studies.solving.result import Result
from studies.solving.solve import solve

TYRE = {"delta_mm": "5,10", "tolerance": "1e-12"}
RUBBED = TYRE | {"mu": "0.3", "drag_mm": "0.3,2"}  # at the first stop half of the candidates stick
MODULI = ("E_L_MPa", "E_T_MPa", "G_LT_MPa", "G_TT_MPa", "p0_MPa")
LENGTHS = ("ply_thickness_mm", "R1_mm", "R0_mm", "delta_mm")


@cache
def solved(name: str, mesh: str, given: tuple[tuple[str, str], ...], model: str = "auto") -> tuple[Any, Result]:
    scene, request = complete(name, dict(given), mesh, model=model)
    return scene, solve(scene, request)


def of(name: str, given: Mapping[str, str], mesh: str, *keys: str) -> list[Derivative]:
    scene, result = solved(name, mesh, tuple(given.items()))
    assert result.outcome.converged
    return gradient.gradients(scene, result, keys or beside.differentiable(scene, result.request))


def last(found: list[Derivative], quantity: str) -> dict[str, Derivative]:
    return {each.setting: each for each in found if each.quantity == quantity}


@pytest.mark.slow
def test_forces_scale_with_moduli_and_with_lengths_squared() -> None:
    """Euler: sum s dF/ds over all moduli and pressures is F, over all lengths 2 F; angles have no part in it."""
    force = last(of("tyre", TYRE, "12x14", *MODULI, *LENGTHS), "force_N")
    value = force["p0_MPa"].value
    for keys, power in ((MODULI, 1.0), (LENGTHS, 2.0)):
        assert sum(force[key].above * force[key].setting_value for key in keys) == pytest.approx(
            power * value, rel=1e-8
        )


def test_what_is_even_in_the_cord_angle_has_no_slope_at_zero() -> None:
    given = TYRE | {"gamma_deg": "0"}
    scene, result = solved("tyre", "12x14", tuple(given.items()), "half")
    even = [
        each
        for each in gradient.gradients(scene, result, ("gamma_deg",))
        if each.quantity in ("force_N", "half_length_mm")
    ]
    assert even
    for each in even:
        assert abs(each.above) <= 1e-8 * abs(each.value)


def test_a_model_that_is_valid_at_one_value_alone_has_no_derivative_with_it() -> None:
    """Cords that are not turned leave mirror planes; the least turn takes them away."""
    scene, result = solved("tyre", "12x14", tuple((TYRE | {"gamma_deg": "0"}).items()))
    assert result.request.model == "quarter"
    assert gradient.gradients(scene, result, ("gamma_deg",)) == []
    assert "quarter" in result.remarks[-1]


@pytest.mark.slow
def test_a_frictional_path_remembers_what_a_setting_did_to_its_anchors() -> None:
    """Dissipation is a modulus times a volume; the drag is one of the lengths, mu of no dimension."""
    once = RUBBED | {"delta_mm": "10", "drag_mm": "2"}  # of a list every value is changed by as much, and not scaled
    mine = last(of("tyre", once, "12x14", *MODULI, *LENGTHS, "drag_mm"), "dissipation_N_mm")
    for keys, power in ((MODULI, 1.0), ((*LENGTHS, "drag_mm"), 3.0)):
        scaled = sum(mine[key].above * mine[key].setting_value for key in keys)
        assert scaled == pytest.approx(power * mine["p0_MPa"].value, rel=1e-7)


@pytest.mark.slow
def test_the_judge_confirms_what_is_right() -> None:
    scene, result = solved("tyre", "8x10", tuple(TYRE.items()))
    checked = taylor.check(scene, result, of("tyre", TYRE, "8x10", "p0_MPa"))
    assert {each.word for each in checked} == {taylor.CONFIRMED}
    assert len(taylor.lines(checked)) == 1


COARSE = ("solve", "tyre", "--mesh", "8x10", "--set", "delta_mm=5", "--no-error")


@pytest.mark.parametrize("off", [0.0, 1e-3])
def test_differences_of_rounding_alone_call_nothing_wrong(off: float) -> None:
    """J = s^2 beside s = 1 to seven digits, its true slope 2 and a wrong one: chance agreement decides nothing."""
    found = list[str]()
    for seed in range(100):
        digits = np.random.default_rng(seed)

        def J(s: float, digits: np.random.Generator = digits) -> dict[str, float]:
            return {"J": s**2 + 1e-7 * float(digits.uniform(-1, 1))}

        ladder = [taylor.Rung(h, J(1 - h), J(1 + h)) for h in (taylor.LARGEST / 2**k for k in range(taylor.RUNGS))]
        slope = 2.0 * (1 + off)
        derivative = Derivative("J", "s", 1.0, 1.0, slope, slope)
        found.append(taylor._checked(derivative, J(1.0), {"J": 1.0}, 1.0, ladder, "").word)
    assert found.count(taylor.WRONG) == (0 if off == 0.0 else len(found))


def test_what_has_no_derivative_is_refused_before_anything_is_solved(tmp_path, capsys, monkeypatch) -> None:
    monkeypatch.setattr(mesh_error, "solve_with_error", lambda *given, **options: pytest.fail("solved"))
    for asked, said in (
        (("--gradient", "force_N:plies"), "plies is not continuous"),
        (("--gradient", "force_N:E_MPa"), "E_MPa has no value here"),
        (("--gradient", "force_N:colour"), "colour is not a setting of tyre"),
        (("--gradient", ":p0_MPa"), "must be QUANTITY"),
        (("--check-gradient",), "--check-gradient needs --gradient"),
    ):
        assert main([*COARSE, *asked, "--out", str(tmp_path / "o")]) == 2
        assert said in capsys.readouterr().err
        assert not (tmp_path / "o").exists()


def test_a_quantity_that_is_not_read_has_no_derivative(tmp_path, capsys) -> None:
    assert main([*COARSE, "--gradient", "weight:p0_MPa", "--out", str(tmp_path / "o")]) == 2
    said = capsys.readouterr()
    assert said.err.startswith("footprint: --gradient weight: there is no such quantity; there are ")
    assert said.err.endswith("; the result is written\n")
    assert said.err.count("\n") == 1
    assert "force_N" in said.out
    written = json.loads((tmp_path / "o" / "result.json").read_text())
    assert written["outcome"] == "converged"
    assert "gradients" not in written
    assert all((tmp_path / "o" / name).is_file() for name in written["files"])


def test_of_several_quantities_those_that_are_read_have_their_derivatives(tmp_path, capsys) -> None:
    asked = ("--gradient", "force_N:p0_MPa", "--gradient", "weight:gamma_deg", "--gradient", "half_length_mm:p0_MPa")
    assert main([*COARSE, *asked, "--out", str(tmp_path / "o")]) == 2
    said = capsys.readouterr()
    assert said.err.startswith("footprint: --gradient weight: there is no such quantity; there are ")
    assert said.err.endswith("; the result is written\n")
    assert said.err.count("\n") == 1
    written = json.loads((tmp_path / "o" / "result.json").read_text())
    assert {name: list(of) for name, of in written["gradients"].items()} == {
        "force_N": ["p0_MPa"],
        "half_length_mm": ["p0_MPa"],
    }
    assert [line.split()[0] for line in said.out.splitlines()].count("p0_MPa") == 2


def test_the_command_writes_what_the_notebook_says(tmp_path, capsys) -> None:
    command = ["solve", "tyre", "--mesh", "8x10", "--set", "delta_mm=5", "--no-error", "--out", str(tmp_path)]
    assert main([*command, "--gradient", "force_N:p0_MPa,gamma_deg"]) == 0
    shown = capsys.readouterr().out
    assert "d force_N / d setting" in shown
    written = json.loads((tmp_path / "result.json").read_text())
    assert "gradients.csv" in written["files"]
    run = solve_here("tyre", mesh="8x10", delta_mm=5, mesh_error=False)
    table = run.gradient("force_N", "p0_MPa", "gamma_deg").set_index("setting")
    for key, entry in written["gradients"]["force_N"].items():
        assert entry["value"] == pytest.approx(table.loc[key, "above"], rel=1e-9)
    with pytest.raises(UsageError, match="not continuous"):
        run.gradient("force_N", "plies")


def test_a_quantity_that_two_stages_read_is_that_of_the_last_load() -> None:
    """The force after a drag is not that of the press: by differences of solutions, which know of no stage."""
    given = TYRE | {"mu": "0.3", "delta_mm": "5", "drag_mm": "1"}
    _, result = solved("tyre", "8x8", tuple(given.items()))
    derivatives = of("tyre", given, "8x8", "mu")
    (force,) = (each for each in derivatives if each.quantity == "force_N")
    ends = [solved("tyre", "8x8", tuple((given | {"mu": mu}).items()))[1] for mu in ("0.299", "0.301")]
    low, high = (end.loads[-1].quantities["force_N"] for end in ends)
    assert force.value == result.loads[-1].quantities["force_N"] != result.quantities["force_N"]
    assert force.above == pytest.approx((high - low) / 0.002, rel=1e-4)
    result = replace(result, gradients={}, tables={})
    gradient.record(result, derivatives)
    assert {"force_N", "friction_N"} <= set(result.table(gradient.TABLE).columns["quantity"])
    assert "friction_N" in result.gradients
    assert "force_N" not in result.gradients  # beside that of the press it would be of another load


def test_a_drag_that_comes_back_to_a_stop_by_differences() -> None:
    """Each leg begins where the one before has ended: steps inside of it move with both of its stops."""

    def dragged(by: float) -> tuple[Any, Result]:
        stops = tuple(stop + by for stop in (0.1, -0.1, 0.1))
        given = {"shape": "plate", "mu": 0.4, "delta_mm": 0.5, "drag_mm": stops, "tolerance": 1e-12}
        scene, request = complete("panel", given, "4x4", steps=2)
        return scene, solve(scene, request)

    scene, result = dragged(0.0)
    (force,) = (each for each in gradient.gradients(scene, result, ("drag_mm",)) if each.quantity == "force_N")
    low, high = (dragged(by)[1].loads[-1].quantities["force_N"] for by in (-1e-4, 1e-4))
    assert force.above == pytest.approx((high - low) / 2e-4, rel=1e-5)


@pytest.mark.parametrize(
    ("pairing", "faces"),
    [("nodes", "facets"), *(pytest.param("mortar", faces, marks=pytest.mark.slow) for faces in ("facets", "curved"))],
)
def test_the_force_between_two_rings_by_differences(pairing: str, faces: str) -> None:
    given = {"pairing": pairing, "faces": faces, "delta_mm": "20,50", "lines": "rim", "tolerance": "1e-12"}
    (force,) = (each for each in of("two-rings", given, "1x10", "h_mm") if each.quantity == "P_H2_over_EI")
    thick, step = 1.0, 1e-4
    ends = [solved("two-rings", "1x10", tuple((given | {"h_mm": repr(thick + by)}).items()))[1] for by in (-step, step)]
    low, high = (end.quantities["P_H2_over_EI"] for end in ends)
    assert abs(high - low) > 1e-6
    assert force.above == pytest.approx((high - low) / (2 * step), rel=1e-6)


def test_what_cannot_be_differentiated_is_a_remark(monkeypatch) -> None:
    scene, result = solved("tyre", "8x10", tuple(TYRE.items()))
    result = replace(result, remarks=[])

    def refused(*_: object) -> None:
        raise ValueError("nothing can be built there")

    monkeypatch.setattr(sides, "changed", refused)
    assert gradient.gradients(scene, result, ("p0_MPa",)) == []
    assert result.remarks == ["no derivative with p0_MPa: nothing can be built there"]


# planted faults: each leaves out one way in which a setting reaches an answer, and the judge names it


@dataclass(frozen=True)
class Planted:
    """A fault, and settings with derivatives that it makes wrong."""

    key: str
    plant: Callable[[pytest.MonkeyPatch], None]


def _changes(**factors: float) -> Callable[[pytest.MonkeyPatch], None]:
    """Parts of a change taken times a factor."""

    def plant(patch: pytest.MonkeyPatch) -> None:
        right = Change.between.__func__

        def wrong(cls: type[Change], *args: Any) -> Change:
            actual = right(cls, *args)
            return replace(actual, **{name: factor * getattr(actual, name) for name, factor in factors.items()})

        patch.setattr(Change, "between", classmethod(wrong))

    return plant


def _rates(**factors: float) -> Callable[[pytest.MonkeyPatch], None]:
    """Parts of rates taken times a factor."""

    def plant(patch: pytest.MonkeyPatch) -> None:
        right = Rates.moved

        def wrong(self: Rates, state: Any, by: float) -> Any:
            known = {name: getattr(self, name) for name in factors if getattr(self, name) is not None}
            return right(replace(self, **{name: factors[name] * value for name, value in known.items()}), state, by)

        patch.setattr(Rates, "moved", wrong)

    return plant


def _unmoved_stage(patch: pytest.MonkeyPatch) -> None:
    """The foundation touches first where it did."""
    right = Side.posed

    def wrong(self: Side, passed: Passed) -> Any:
        if passed.stage is not self.of and self.last is not None:
            self.last = self.held
        actual = right(self, passed)
        self.held = passed.state
        return actual

    patch.setattr(Side, "posed", wrong)


def _unmoved_anchors(patch: pytest.MonkeyPatch) -> None:
    """Slips are counted from where the candidates were."""
    right = Side.posed

    def wrong(self: Side, passed: Passed) -> Any:
        problem, epsilon = right(self, passed)
        if problem.coulomb is not None:
            problem = self.problem = problem.since(passed.problem.coulomb.sliding.anchors)
        return problem, epsilon

    patch.setattr(Side, "posed", wrong)


def _forgets(name: str, value: Callable[..., Any]) -> Callable[[pytest.MonkeyPatch], None]:
    return lambda patch: patch.setattr(Side, name, value)


PLANTED = {
    "loads of the parameter halved": Planted("p0_MPa", _changes(residual=0.5)),
    "gaps that the parameter opens left out": Planted("delta_mm", _changes(gap=0.0)),
    "slips left out": Planted("drag_mm", _changes(slip=0.0)),
    "ways of those that stick left out": Planted("delta_mm", _changes(stretched=0.0)),
    "the bound of friction left out": Planted("mu", _changes(bound=0.0)),
    "the bound of friction with its sign turned": Planted("mu", _changes(bound=-1.0)),
    "pressures that do not follow": Planted("p0_MPa", _rates(pressure=0.0)),
    "friction that does not follow": Planted("p0_MPa", _rates(friction=0.0)),
    "first touch that does not follow": Planted("p0_MPa", _unmoved_stage),
    "anchors that do not follow": Planted("gamma_deg", _unmoved_anchors),
    "a travel that does not follow": Planted("delta_mm", _forgets("_parameter", lambda self, passed: passed.t)),
    "dissipation forgotten": Planted("drag_mm", _forgets("_remembered", lambda self, problem, state: state)),
}


@cache
def rungs_of(key: str) -> tuple[list[taylor.Rung], Result, dict[str, float], float]:
    scene, result = solved("tyre", "12x14", tuple(RUBBED.items()))
    unit = beside.width_of(scene, result.request, key, 1.0)
    rungs, why = taylor._rungs(scene, result, key, taylor.LARGEST / 8 * unit)
    assert not why
    return rungs, result, taylor._sizes(result), unit


def words(key: str) -> set[str]:
    rungs, result, sizes, unit = rungs_of(key)
    actual = of("tyre", RUBBED, "12x14", key)
    assert actual
    return {taylor._checked(each, gradient.values_of(result), sizes, unit, rungs, "").word for each in actual}


@pytest.mark.slow
@pytest.mark.parametrize("name", PLANTED)
def test_a_wrong_partial_derivative_is_named(monkeypatch, name: str) -> None:
    planted = PLANTED[name]
    assert taylor.WRONG not in words(planted.key)
    planted.plant(monkeypatch)
    assert taylor.WRONG in words(planted.key)
