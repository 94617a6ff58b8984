"""What a scene, a strain measure or a contact algorithm is: its meaning, formulas, settings, references and source.

Everything is read from the part itself; nothing is said here about a particular one. And scenes as functions of their
settings, whose names, types and defaults a notebook or an interpreter completes: nothing is solved or checked here.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, fields
from inspect import Parameter, Signature, signature
from typing import TYPE_CHECKING, Any, Literal

from contact.catalogue import ALGORITHMS
from contact.problem import ContactAlgorithm
from formulations.strains.catalogue import MEASURES
from formulations.strains.measure import RigidBodyLaw, StrainMeasure
from studies.ask.request import names_for, text_of
from studies.ask.scene import Reference, Scene, Setting, UsageError, models_of, settings_beside
from studies.ask.settings import parameters_of
from studies.output.terminal import Shown, columns
from studies.scenes import SCENES

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = ("name", "meaning", "unit", "range", "default")


@dataclass(frozen=True, eq=False, repr=False)
class Description(Shown):
    """A part of the catalogues.

    kind: "scene", "measure" or "algorithm".  meaning: one line.  text: what ``footprint show`` prints.
    rows: name, meaning, unit, range and default of each setting.
    """

    name: str
    kind: str
    meaning: str
    text: str
    rows: tuple[tuple[str, ...], ...]

    @property
    def line(self) -> str:
        """Name, kind and meaning."""
        return f"{self.name} ({self.kind}): {self.meaning}"

    def shown(self) -> tuple[pd.DataFrame, list[str]]:
        """Its settings."""
        return self.settings, []

    @property
    def settings(self) -> pd.DataFrame:
        """Name, meaning, unit, range and default, a row a setting."""
        import pandas as pd

        return pd.DataFrame(self.rows, columns=list(COLUMNS))


def describe(name: str) -> Description:
    """The description of a part; raises UsageError for an unknown name."""
    if not isinstance(name, str):
        raise UsageError(f"{name!r} is not a name of a part, see footprint list")
    if name in SCENES:
        scene = SCENES[name]
        return _described(name, "scene", _of_scene(scene), (*scene.settings, *settings_beside(scene)))
    if name in MEASURES:
        return _described(name, "measure", _of_measure(MEASURES[name]), ())
    if name in ALGORITHMS:
        return _described(name, "algorithm", _of_algorithm(ALGORITHMS[name]()), parameters_of(name))
    known = names_for(name, (*SCENES, *MEASURES, *ALGORITHMS), "footprint list")
    raise UsageError(f"{name!r} must be one of {known}")


def meaning_of(name: str) -> str:
    """One line: the title of a scene, what a measure neglects, what an algorithm does."""
    if name in SCENES:
        return SCENES[name].title
    if name in MEASURES:
        measure = MEASURES[name]
        said = getattr(measure, "meaning", None)  # a table has one, or its source; else the docstring of a class
        return paragraphs(measure)[0] if said is None else said or measure.reference
    return paragraphs(ALGORITHMS[name]())[0]


def _described(name: str, kind: str, body: Iterable[str], settings: Sequence[Setting]) -> Description:
    meaning = meaning_of(name)
    rows = tuple((s.key, s.help, s.unit, s.range_text, s.default_text) for s in settings)
    lines = [f"{name} ({kind}): {meaning}", *body]
    if rows:
        shown = [(key, default, unit, allowed, text) for key, text, unit, allowed, default in rows]
        lines += ["", "settings, --set KEY=VALUE:"]
        lines += columns([("key", "default", "unit", "range", "meaning"), *shown], "  ")
    if kind == "scene":
        lines += _references(SCENES[name].references)
    return Description(name, kind, meaning, "\n".join(lines), rows)


def _of_scene(scene: Scene) -> Iterator[str]:
    yield from ("", *said_of_scene(scene).splitlines(), "")
    yield f"mesh {scene.default_mesh[0]}x{scene.default_mesh[1]} by default, elements along a1 and a2"
    yield f"models {', '.join(models_of(scene))}"


def said_of_scene(scene: Scene) -> str:
    """What its module, its class and its building are documented with, but for the fields of the class."""
    documented = (inspect.getmodule(type(scene)), type(scene), scene.build)
    fields = tuple(f"{name}: " for name in getattr(type(scene), "__dataclass_fields__", ()))
    texts = [text for each in documented for text in plain_text(inspect.getdoc(each) or "").split("\n\n")]
    return "\n\n".join(text for text in texts if text and not text.startswith(fields))


def _references(references: Sequence[Reference]) -> Iterator[str]:
    if not references:
        yield from ("", "references: none")
        return
    yield from ("", "references:")
    rows = [("quantity", "value", "uncertainty", "kind", "at", "source")]
    for each in references:
        at = ", ".join(f"{key}={text_of(v)}" for key, v in each.at.items())
        rows.append((each.quantity, f"{each.value:.6g}", f"{100 * each.uncertainty:g} %", each.kind, at, each.source))
    yield from columns(rows, "  ")


def _of_measure(measure: StrainMeasure) -> Iterator[str]:
    formulas: dict[str, str] = getattr(measure, "formulas", {})
    if formulas:
        yield from ("", "strains of a face, of l, w, t = lam, om, th over zeta and beta = (v+ - v-)/h:")
        yield from (f"  {strain:4s} = {formula}" for strain, formula in formulas.items())
        yield from (f"  {formula}" for formula in kinematics_of(measure))
    else:
        yield from ("", *paragraphs(measure)[1:])
    yield from ("", "strain left by a rigid motion (amount or angle theta, stretch zeta of the face), by its law:")
    yield from columns([(f.name, law_text(measure.rigid_body_law, f.name)) for f in fields(RigidBodyLaw)], "  ")
    yield from ("", f"source: {measure.reference}")


def kinematics_of(measure: StrainMeasure) -> tuple[str, str]:
    """The slope and the stretch of a face, with what the measure keeps of them."""
    shallow, thin = measure.kinematics.shallow, measure.kinematics.thin
    return f"th_a = -v_3,a/A_a{'' if shallow else ' + k_a v_a'}", f"zeta_a = 1{'' if thin else ' + k_a d'}"


def law_text(laws: RigidBodyLaw, motion: str) -> str:
    """A law in one line: its formula, or its value where it states none."""
    law = getattr(laws, motion)
    stated = (inspect.getdoc(law) or "").splitlines()
    return stated[0] if stated else f"{law(0.1, 1.05):.3g} at 0.1, zeta = 1.05"


def _of_algorithm(algorithm: ContactAlgorithm) -> Iterator[str]:
    for paragraph in paragraphs(algorithm)[1:]:
        yield from ("", *paragraph.splitlines())
    if when := inspect.getdoc(algorithm.supports):
        yield from ("", f"when: {when}")


def paragraphs(part: object) -> list[str]:
    """The docstring of the part's class; its module's where the class has none."""
    text = inspect.getdoc(type(part)) or inspect.getdoc(inspect.getmodule(type(part))) or ""
    return plain_text(text).split("\n\n")


def plain_text(text: str) -> str:
    """A docstring without its markup."""
    text = re.sub(r":\w+:`([^`]*)`", r"\1", text).replace("``", "")
    text = text.replace("Raises UsageError", "Refused").replace("raises UsageError", "refused")
    return re.sub(r"(?<=\S) +", " ", text)


KINDS: dict[str, Any] = {"float": float, "int": int, "floats": Sequence[float], "path": Sequence[float]}


class Scenes:
    """``scene.two_rings(delta_mm=50, mesh="1x20")`` is ``solve("two-rings", delta_mm=50, mesh="1x20")``.

    Each function has the options of ``solve``, the settings of its scene, and those of the algorithm in ``contact`` by
    default.
    """

    def __init__(self, solve: Callable[..., Any]) -> None:
        """solve: :func:`studies.notebook.solve`, which loads more than is known here."""
        self._solve = solve

    def __dir__(self) -> list[str]:
        return [name.replace("-", "_") for name in SCENES]

    def __getattr__(self, name: str) -> Callable[..., Any]:
        scene = next((each for each in SCENES if each.replace("-", "_") == name), None)
        if scene is None:
            raise AttributeError(f"no scene {name!r}: footprint list scenes")

        def solved(**given: Any) -> Any:
            return self._solve(scene, **given)

        solved.__name__, solved.__doc__ = name, describe(scene).text
        solved.__signature__ = self._signature(scene)  # type: ignore[attr-defined]  # what inspect reads
        return solved

    def _signature(self, name: str) -> Signature:
        options = [each for each in signature(self._solve).parameters.values() if each.kind is Parameter.KEYWORD_ONLY]
        contact = next(each.default for each in options if each.name == "contact")
        scene, taken = SCENES[name], {each.name for each in options}
        settings = {each.key: each for each in (*scene.settings, *settings_beside(scene), *parameters_of(contact))}
        return Signature([*options, *(_keyword(each) for key, each in settings.items() if key not in taken)])


def _keyword(setting: Setting) -> Parameter:
    kind = Literal[tuple(setting.choices)] if setting.kind == "choice" else KINDS[setting.kind]
    return Parameter(setting.key, Parameter.KEYWORD_ONLY, default=setting.default, annotation=kind)
