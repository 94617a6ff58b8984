"""What is asked of a solve: one frozen, hashable record, resolved once and carried as data to the tables.

Nothing reads a command or a label back: requests that differ in the mesh alone have the same ``key(("mesh",))``.
Neither scenes nor files enter here.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from difflib import get_close_matches
from types import UnionType
from typing import Any, Self

Value = float | int | str | tuple[float, ...]
Leaves = tuple[tuple[int, int, int], ...]
FEW = 12  # names that a line may list
ALIKE = 0.6  # ratio of equal letters, from which on a name may be what was meant


class UsageError(ValueError):
    """A wrong request; its message is the one line the user reads."""


def names_for(wrong: object, names: Collection[str], where: str) -> str:
    """The names there are, for the line that refuses a wrong one: few of them all, of many those that read like it.

    where: the command that lists all.
    """
    if len(names) <= FEW:
        return ", ".join(names)
    alike = ", ".join(get_close_matches(str(wrong), names, 5, ALIKE))
    return f"{len(names)}, see {where}" + (f"; did you mean {alike}?" if alike else "")


class PartError(Exception):
    """A part from outside that breaks while it is used; its message is the one line the user reads."""


class Settings(Mapping[str, Value]):
    """Values by key: frozen, hashable, and typed where they are read; raises TypeError for a value of another type."""

    def __init__(self, values: Mapping[str, Value] | None = None) -> None:
        self._values = dict(values or {})

    def __getitem__(self, key: str) -> Value:
        return self._values[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __hash__(self) -> int:
        return hash(frozenset(self._values.items()))

    def __repr__(self) -> str:
        return f"Settings({self._values!r})"

    def with_values(self, **values: Value) -> Settings:
        """The settings, some of them changed or added."""
        return Settings({**self._values, **values})

    def number(self, key: str) -> float:
        """The value of a setting that is one number."""
        return float(self._typed(key, float | int, "a number"))

    def numbers(self, key: str) -> tuple[float, ...]:
        """The values of a setting that is a list of numbers."""
        return tuple(self._typed(key, tuple, "a list of numbers"))

    def choice(self, key: str) -> str:
        """The value of a setting that is a word."""
        return str(self._typed(key, str, "a word"))

    def _typed(self, key: str, kind: type | UnionType, what: str) -> Any:
        value = self._values[key]
        if isinstance(value, kind):
            return value
        raise TypeError(f"{key} = {value!r} is not {what}")


@dataclass(frozen=True)
class Request:
    """Everything that decides a result, resolved: no default is left open.

    mesh: elements along a1 and a2.  leaves: of the quadtree over them, see
    :class:`formulations.geometry.quadtree.Quadtree`; none: the mesh itself.
    model_reason: why this model, for people; it decides nothing.
    """

    scene: str
    measure: str = "exact"
    contact: str = "semismooth"
    newton: str = "mixed"
    mesh: tuple[int, int] = (0, 0)
    model: str = "auto"
    model_reason: str = field(default="", compare=False)
    steps: int = 1
    settings: Settings = Settings()  # noqa: RUF009  frozen
    leaves: Leaves = ()

    @classmethod
    def of(cls, data: Mapping[str, Any]) -> Self:
        """The request of its plain data, as the index of a campaign holds it."""
        settings = Settings({key: _value(value) for key, value in data["settings"].items()})
        leaves = tuple((int(level), int(i), int(j)) for level, i, j in data.get("leaves", ()))
        return cls(**{**data, "mesh": tuple(data["mesh"]), "settings": settings, "leaves": leaves})

    @property
    def data(self) -> dict[str, Any]:
        """All that decides the result, as plain data; what :meth:`of` reads."""
        left_out = {"model_reason"} if self.leaves else {"model_reason", "leaves"}
        return {key: value for key, value in asdict(self).items() if key not in left_out}

    @property
    def values(self) -> dict[str, Value]:
        """All that decides the result, by name: fields and settings alike."""
        fields = ["scene", "measure", "contact", "newton", "mesh", "model", "steps"]
        if self.leaves:
            fields.append("leaves")
        return {**{name: getattr(self, name) for name in fields}, **self.settings}

    @property
    def mesh_text(self) -> str:
        """N1xN2."""
        return "{}x{}".format(*self.mesh)

    def key(self, without: Collection[str] = ()) -> str:
        """Equal for two requests that differ in nothing but ``without``; not made to be read back."""
        values = self.values
        return " ".join(f"{name}={text_of(values[name])}" for name in sorted(values) if name not in without)

    def number(self, key: str) -> float:
        """The value of a setting that is one number."""
        return self.settings.number(key)

    def numbers(self, key: str) -> tuple[float, ...]:
        """The values of a setting that is a list of numbers."""
        return self.settings.numbers(key)

    def choice(self, key: str) -> str:
        """The value of a setting that is a word."""
        return self.settings.choice(key)


def text_of(value: object) -> str:
    """A value as it is written after KEY= on the command line: the shortest text that reads back to the same."""
    if isinstance(value, list | tuple):
        return ",".join(text_of(each) for each in value)
    short = f"{value:g}" if isinstance(value, float) else str(value)
    return repr(value) if isinstance(value, float) and float(short) != value else short


def _value(data: Any) -> Value:
    """A value of a setting from JSON, which has neither tuples nor infinities."""
    if isinstance(data, list):
        return tuple(float(each) for each in data)
    return float(data) if data in ("inf", "-inf") else data
