"""What a notebook holds after a call: an answer with its values, data frames and figures, and how it shows itself.

Nothing is asked or solved here, see :mod:`studies.notebook`.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from studies.output.terminal import Shown
from studies.scenes import SCENES
from studies.solving.choice import Choice
from studies.solving.result import Result
from studies.solving.variants import ELEMENT, FACES, MEASURE, REFERENCE, SURFACES
from studies.sweeps import sweep as sweeping

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

HEADLINE = 4  # quantities, or reasons, that are shown
AS_ASKED = "as asked for"  # of the element of the reference
FIGURES = {MEASURE: "measures.svg", SURFACES: "surfaces.svg", FACES: "faces.svg", ELEMENT: "elements.svg"}


def _frame(rows: Sequence[Mapping[str, Any]], columns: list[str] | None = None) -> pd.DataFrame:
    import pandas as pd  # slow to load, and not there where only the numbers are wanted

    return pd.DataFrame(rows, columns=columns)


@dataclass(frozen=True, eq=False, repr=False)
class Run(Shown):
    """A solved request; where it did not converge, everything up to the last converged step."""

    result: Result

    @property
    def line(self) -> str:
        """Request, verdict, and the quantities at the end."""
        request = self.result.request
        headline = ", ".join(f"{name} {value:.6g}" for name, value in list(self.quantities.items())[:HEADLINE])
        how = f"{request.scene} {request.mesh_text}, {request.measure}, {request.contact}"
        return f"{how}: {self.verdict}{f'; {headline}' if headline else ''}; {self.result.timing['total']:.3g} s"

    def shown(self) -> tuple[pd.DataFrame, list[str]]:
        """Its loads, limits of what has an error, and notes."""
        errors = [f"{name} within {each['low']:.6g} to {each['high']:.6g}" for name, each in self.errors.items()]
        reason = [] if self.result.outcome.converged else [self.reason]
        return self.steps, [*reason, *errors, *self.notes]

    @property
    def outcome(self) -> str:
        """As in result.json, "converged" or what else it ended in."""
        return str(self.result.as_json()["outcome"])

    @property
    def verdict(self) -> str:
        """The judge's word: "converged", "unstable", "wrong" or, of what it had nothing to judge, the class."""
        return self.result.verdict

    @property
    def reason(self) -> str:
        """Why it ended."""
        return str(self.result.as_json()["reason"])

    @property
    def notes(self) -> list[str]:
        """What the answer does not show by itself."""
        return self.result.notes

    @property
    def steps(self) -> pd.DataFrame:
        """A row for each requested load: the load, what is read off, and the counts of its solution.

        Where no load was reached there is no row; the columns of what is read off are there all the same.
        """
        rows = [{**step.seen, **step.counters} for step in self.result.loads]
        return _frame(rows, columns=None if rows else self._columns())

    def _columns(self) -> list[str]:
        """What the stage that ended would have read off, as it reads it where its path begins."""
        end = self.result.end
        if end is None:
            return []
        with np.errstate(all="ignore"):
            readings = end.stage.observe(end.problem_at(end.point.reached), end.before, end.point.reached).step
        return list(readings or ())

    def at(self, load: float, passage: int = 0) -> dict[str, float]:
        """What is read off where a curve followed by power series passes a load, the first time or later: the load
        and {name_unit: value}.

        ``passage``: 1, 2, ... for later times.  Raises LookupError as :meth:`studies.solving.result.Result.at`, which
        gives the state itself.
        """
        state, end = self.result.at(load, passage), self.result.end
        assert end is not None
        return dict(end.stage.observe(end.problem_at(load), state, load).step or {})

    @property
    def certificate(self) -> pd.DataFrame:
        """A row for each requested load: residuals and balances as recomputed, what fails, and stability."""
        rows = []
        for step in self.result.loads:
            record = step.certificate
            verdict = {"failures": ", ".join(record["failures"]), "stability": record["stability"]["word"]}
            rows.append({**record["kkt"], **record["balances"], **verdict})
        return _frame(rows)

    @property
    def quantities(self) -> dict[str, float]:
        """Headline values {name_unit: value}."""
        return dict(self.result.quantities)

    @property
    def errors(self) -> dict[str, dict[str, float]]:
        """Intervals {quantity: {low, high}} of what coarser grids and, with friction, half the load steps say."""
        return dict(self.result.errors)

    def gradient(self, quantity: str, *settings: str, check: bool = False) -> pd.DataFrame:
        """Derivatives of a quantity with settings, by default all that are continuous: a row a setting.

        above and below: dJ/ds of a setting that grows and shrinks, the same but where candidates touch without
        pressure.  relative: per cent for a per cent.  check: judge them by solutions beside, which costs six solves a
        setting.  Raises UsageError for what is not there or has no derivative.
        """
        from studies.solving.derivatives import beside, gradient, taylor  # loaded with derivatives alone

        request = self.result.request
        scene = SCENES[request.scene]
        keys = beside.differentiable(scene, request, settings)
        gradient.check_quantities(self.result, [quantity])
        derivatives = gradient.of_quantities(scene, self.result, [(quantity, keys)])
        gradient.record(self.result, derivatives)
        if check:
            return _frame([each.row for each in taylor.check(scene, self.result, derivatives)])
        return _frame([each.row for each in derivatives])

    @property
    def cost(self) -> dict[str, float]:
        """Counters and, ending in _s, seconds."""
        return {**self.result.counters, **{f"{name}_s": time for name, time in self.result.timing.items()}}

    def figures(self) -> list[Figure]:
        """The pictures of ``--plot`` as matplotlib's figures."""
        from reports.figures.result_figures import figures_of

        with tempfile.TemporaryDirectory() as folder:
            self.write(folder)
            return figures_of(Path(folder))

    def write(self, directory: str | Path) -> None:
        """result.json, fields.vtu and the tables, as ``footprint solve --out`` writes them."""
        self.result.write(Path(directory))


@dataclass(frozen=True, eq=False, repr=False)
class Chosen(Shown):
    """An answer of :func:`choose`; where nothing is enough, what is known all the same."""

    choice: Choice

    @property
    def line(self) -> str:
        """The recommended command, or why nothing is recommended."""
        offer = self.recommended
        return f"no recommendation: {self.choice.reason}" if offer is None else str(offer["command"])

    def shown(self) -> tuple[pd.DataFrame, list[str]]:
        """Variants, and what is uncertain."""
        return self.variants, self.uncertain

    @property
    def recommended(self) -> dict[str, Any] | None:
        """command, mesh, error_at_most and seconds of the cheapest that is enough; None where nothing is."""
        return None if self.choice.recommended is None else self.choice.recommended.data

    @property
    def runner_up(self) -> dict[str, Any] | None:
        """The same of the next one."""
        return None if self.choice.runner_up is None else self.choice.runner_up.data

    @property
    def variants(self) -> pd.DataFrame:
        """A row a measure, an option of the element, a model: its error in the limit of the meshes, and its mesh."""
        return _frame(self.choice.variants)

    @property
    def grids(self) -> pd.DataFrame:
        """A row each of their grids."""
        return _frame(self.choice.grids)

    @property
    def algorithms(self) -> pd.DataFrame:
        """A row an algorithm of contact: how it ended, from rest, on a mesh that is enough."""
        return _frame(self.choice.trials)

    @property
    def uncertain(self) -> list[str]:
        """What this answer does not know."""
        return self.choice.uncertain

    def write(self, directory: str | Path) -> None:
        """What ``footprint choose --out`` writes."""
        write_choice(self.choice, Path(directory))


@dataclass(frozen=True, eq=False, repr=False)
class Swept(Shown):
    """An answer of :func:`sweep`; found: its ranges and members."""

    found: sweeping.Sweep

    @property
    def line(self) -> str:
        """How many members there are of which ranges, and how many have an answer."""
        over = " x ".join(f"{each.key} ({len(each.values)})" for each in self.found.ranges)
        count = len(self.found.members)
        return f"{self.found.name} over {over}: {count - len(self.found.failed)} of {count} solved"

    def shown(self) -> tuple[pd.DataFrame, list[str]]:
        """Members, and the reasons of those without an answer."""
        return self.members, [f"{each.verdict}: {each.reason}" for each in self.found.failed[:HEADLINE]]

    @property
    def members(self) -> pd.DataFrame:
        """A row a member: settings, verdict, quantities at the last load, its error where one was asked for, costs."""
        return _frame(self.found.rows)

    def figure(self) -> Figure:
        """The quantity over one setting, or its map over two."""
        from reports.figures.comparisons import swept
        from reports.figures.drawing import drawn

        with drawn() as figures:
            swept(*self.found.picture)()
        return figures[0]

    def write(self, directory: str | Path) -> None:
        """What ``footprint sweep --out`` writes, but for the files of members."""
        from reports.figures.comparisons import draw_sweep

        self.found.write(Path(directory), draw_sweep(Path(directory), *self.found.picture))


def write_choice(choice: Choice, out: Path) -> None:
    """The pictures, the tables, and choice.json, which comes last."""
    from reports.figures.comparisons import error_over_seconds
    from reports.files import write_texts

    pictures = {}
    for axis, name in FIGURES.items():
        others = [each for each in choice.verdicts[1:] if each.ladder.variant.axis == axis and each.ladder.paths]
        if choice.truth is None or not others:
            continue
        wall = others[0].ladder.variant.wall  # that all of them have
        walls = {each.ladder.variant.name: each for each in choice.verdicts if each.ladder.variant.axis == SURFACES}
        beside = walls.get(wall, choice.verdicts[0])
        reference = [row | {"name": REFERENCE if axis == MEASURE else AS_ASKED} for row in beside.grids]
        rows = [*reference, *(row for verdict in others for row in verdict.grids)]
        on_wall = f", {SURFACES}={wall}" if wall else ""
        named = [row | {"name": f"{row['name']}{on_wall}"} for row in rows]
        pictures[name] = error_over_seconds(named, choice.quantity, choice.question.error, choice.truth.uncertainty)()
    write_texts(out / "figures", pictures)
    choice.write(out, [f"figures/{name}" for name in pictures])
