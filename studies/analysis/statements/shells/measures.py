"""What is said of strain measures: exact against classical ones by regime, and on the tyre."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pandas as pd

from studies.analysis.statements.record import FINDING, OPENING, Statement

EXACT, LINEAR = "exact", "linear"
ENOUGH = 0.05
NO_SAVING = 0.95  # of the seconds of the exact measure: what is dearer than this saves nothing
SLUGS = {
    "shallow shells": "shallow",
    "contact of a tyre": "tyre",
    "contact of a ring": "ring",
    "large rotations": "large",
}


def named(names: list[str]) -> str:
    """Names as code, or none."""
    return ", ".join(f"`{name}`" for name in names) or "none"


def _capital(words: str) -> str:
    return words[:1].upper() + words[1:]


def by_regime(regimes: pd.DataFrame) -> Iterator[Statement]:
    """A sentence for each regime: which nonlinear measures follow the exact one, and how far off the others are."""
    whole = regimes[regimes["scene"].isna()]
    for regime, own in whole.groupby("regime", sort=False):
        others = own[(own["measure"] != EXACT) & own["error"].notna()].set_index("measure")
        if LINEAR not in others.index or len(others) < 2:
            continue
        curved = others.drop(index=LINEAR)
        sizes = curved["error"].abs()
        close = [str(name) for name in sizes.index[sizes <= ENOUGH]]
        worst, errors = str(sizes.idxmax()), {str(name): float(error) for name, error in others["error"].items()}
        values: dict[str, float | str] = {"regime": _capital(str(regime)), "linear": errors[LINEAR]}
        values |= {"count": float(len(close)), "of": float(len(curved)), "close": named(close), "level": ENOUGH}
        values |= {"worst": f"`{worst}`", "off": errors[worst]}
        text = "{regime}: linear strains are off by up to {linear:+.0%}; "
        if len(close) == len(curved):
            text += (
                "all {of:.0f} other measures stay within {level:.0%} of the exact one, at worst {off:+.1%} ({worst})."
            )
        else:
            text += (
                "of {of:.0f} nonlinear measures {close} stay within {level:.0%} of the exact one, the worst ({worst}) "
                "is {off:+.0%} off."
            )
        scope = f"{own['why'].iloc[0]}; errors against the exact measure on the same mesh, the largest on the way"
        name = f"measures-{SLUGS.get(str(regime), str(regime))}"
        yield Statement(name, "measures", text, values, int(own["scenes"].max()), scope, OPENING)


def cost(regimes: pd.DataFrame) -> Iterator[Statement]:
    """What a classical measure saves."""
    own = regimes[regimes["scene"].isna() & (regimes["measure"] != EXACT)].dropna(subset=["seconds_ratio"])
    linear, curved = own[own["measure"] == LINEAR]["seconds_ratio"], own[own["measure"] != LINEAR]["seconds_ratio"]
    if linear.empty or curved.empty:
        return
    values = {"low": curved.min(), "high": curved.max(), "linear_low": linear.min(), "linear_high": linear.max()}
    values |= {"middle": curved.median(), "both": float(own["both"].sum())}
    text = (
        "On the same problems a nonlinear classical measure takes {low:.2f} to {high:.2f} times the processor time of "
        "the exact one ({middle:.2f} in the median), a linear one {linear_low:.2f} to {linear_high:.2f}"
    )
    if values["middle"] >= NO_SAVING:
        text += ": use exact strains, or linear ones where the answer is known to stay linear"
    scope = "medians by regime over problems that both measures solve, same mesh and load"
    yield Statement("measures-cost", "measures", f"{text}.", values, int(values["both"]), scope, OPENING, machine=True)


def tyre(measure_limits: pd.DataFrame, regimes: pd.DataFrame) -> Iterator[Statement]:
    """Which measure for 20 mm of tyre at 5 %, and what it saves."""
    own = measure_limits[measure_limits["scene"] == "tyre"].set_index("measure")
    if LINEAR not in own.index:
        return
    close = [str(name) for name in own.index[own["largest"].abs() <= ENOUGH]]
    linear = own[own.index == LINEAR].to_dict("records")[0]
    values: dict[str, float | str] = {"load": linear["load"], "level": ENOUGH, "close": named(close)}
    values |= {"linear": linear["error"], "largest": linear["largest"], "at": linear["largest_at"]}
    text = (
        "For {load:g} mm of travel of the tyre within {level:.0%} of the exact measure all the way: {close}. Linear "
        "strains are {linear:+.0%} off there"
    )
    values["first"] = first = float(linear["first_5"])
    text += " and beyond {level:.0%} from the first travel on." if first == 0 else " and leave it at {first:.3g} mm."
    scope = "20x20 elements on the whole tyre, dead load, force of the plane"
    yield Statement("tyre-measure", "measures", text, values, len(own) + 1, scope, FINDING)
    whole = regimes[(regimes["regime"] == "contact of a tyre") & regimes["scene"].isna()]
    saved = whole.set_index("measure")["seconds_ratio"].dropna()
    known = saved.reindex([name for name in close if name in saved.index]).dropna()
    if known.empty:
        return
    best = str(known.idxmin())
    ratio = float(known[best])
    values = {"name": f"`{best}`", "ratio": ratio, "saved": 1 - ratio}
    both = int(whole.set_index("measure")["both"][best])
    text = "Of these {name} takes least on the tyre: {ratio:.2f} times the processor time of the exact measure"
    text += "; that saves {saved:.0%}." if ratio < NO_SAVING else ", which saves next to nothing."
    yield Statement("tyre-measure-saves", "measures", text, values, both, scope, FINDING, machine=True)


def enough(measure_limits: pd.DataFrame) -> Iterator[Statement]:
    """From which load on linear is not enough, scene by scene."""
    own = measure_limits[measure_limits["measure"] == LINEAR]
    if own.empty:
        return
    never = own[own["first_5"].isna()]["scene"]
    shares = (own["first_5"] / own["load"]).fillna(math.inf)
    values: dict[str, float | str] = {"scenes": float(len(own)), "early": float((shares <= 0.1).sum())}
    values |= {"least": float(own["largest"].abs().min()), "most": float(own["largest"].abs().max())}
    values |= {"never": ", ".join(map(str, never)) or "none"}
    text = (
        "Linear strains leave 5 % within the first tenth of the load in {early:.0f} of {scenes:.0f} scenes; their "
        "largest error is between {least:.0%} and {most:.0%} (never beyond 5 %: {never})."
    )
    scope = "one mesh a scene, loads up to the last one of its curve"
    yield Statement("linear-enough", "measures", text, values, len(own), scope, FINDING)


MAKERS = (by_regime, cost, tyre, enough)
