"""Numbers and names as text: without negative zeros, and with a dash for what does not exist."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from string import Formatter
from typing import Any

NOTHING = "–"  # for a number that does not exist: None or NaN


def formatted(value: float | None, form: str) -> str:
    """A number by a format of Python's: "+.2f", ".1e", "g", or ".1%" for a fraction in per cent.

    What does not exist is a dash, what rounds to zero has no sign, and of exact zero no exponent is shown.
    """
    if value is None or math.isnan(value):
        return NOTHING
    text = "0" if value == 0.0 and form.endswith("e") else f"{value:{form}}"
    return (text.lstrip("+-") if float(text.rstrip("%")) == 0.0 else text).replace("%", " %")


def fixed(value: float | None, decimals: int = 0) -> str:
    """``decimals`` places."""
    return formatted(value, f".{decimals}f")


def percent(fraction: float | None) -> str:
    """A change in per cent, with its sign."""
    return formatted(fraction, "+.2%")


def share(fraction: float | None, decimals: int = 2) -> str:
    """A size in per cent, without a sign."""
    return formatted(fraction, f".{decimals}%")


def digits(value: float, count: int) -> str:
    """``count`` significant digits, trailing zeros kept."""
    return formatted(value, f"#.{count}g")


def number(value: float) -> str:
    """Six significant digits at most."""
    return formatted(value, "g")


def scientific(value: float | None, decimals: int = 1) -> str:
    """Mantissa and exponent."""
    return formatted(value, f".{decimals}e")


def bound(error: float) -> str:
    """An error that is asked for, in per cent."""
    return f"{number(100 * error)} %"


def code(name: object) -> str:
    """A name as it is typed; a dash for none."""
    return NOTHING if name == "" else f"`{name}`"


def codes(names: Iterable[object]) -> str:
    """Names as they are typed."""
    return ", ".join(map(code, names))


def said(words: object) -> str:
    """Words; a dash for none."""
    return str(words) if words and words == words else NOTHING


def quantity(name: str) -> str:
    """The name of a quantity in words, with its unit: "limit_w_C_mm" is "w at C at the limit [mm]"."""
    bare, unit = next(((name.removesuffix(end), word) for end, word in UNITS.items() if name.endswith(end)), (name, ""))
    limit = bare.startswith("limit_") and bare != "limit_load_fraction"
    bare = bare.removeprefix("limit_") if limit else bare
    words = WORDS.get(bare) or POINT.sub(r"\1 at \2", bare).replace("_", " ")
    return words + " at the limit" * limit + unit


UNITS = {"_N_per_mm": " [N/mm]", "_mm": " [mm]", "_MPa": " [MPa]", "_N": " [N]", "_deg": " [deg]"}
POINT = re.compile(r"^([uw])_([A-C])\b")  # a displacement at a named point
WORDS = {
    **{
        f"N_{sub}_{place}": f"N{letter} {place}"
        for sub, letter in (("theta", "θ"), ("phi", "φ"))
        for place in ("crown", "inner", "outer")
    },
    "P_H2_over_EI": "P H²/EI",
    "P_R2_over_EI": "P R²/EI",
    "sigma_x_bar": "σx, scaled",
    "tau_xz_bar": "τxz, scaled",
    "tau_yz_bar": "τyz, scaled",
    "w_bar": "w, scaled",
    "w_apex": "w at the apex",
    "w_waist": "w at the waist",
    "w_A_even": "w at A, of large elements",
    "w_C_even": "w at C, of large elements",
}


class Line(Formatter):
    """Fills in "{name:format}" from a record, a mapping or an object, as str.format does but for the formats.

    They are those of ``formatted``, some by name ("bound", "code", "codes", "said", "quantity") and ``named`` ones;
    without one a value is printed as it is. In "{kkt[tension]:.1e}" an entry of a value is meant.
    """

    def __init__(self, named: Mapping[str, Callable[[Any], str]]) -> None:
        self.named: dict[str, Callable[[Any], str]] = {
            **{each.__name__: each for each in (bound, code, codes, said, quantity)},
            **named,
        }

    def filled(self, text: str, record: Any) -> str:
        """The text with the values of a record."""
        return self.vformat(text, (record,), record if isinstance(record, Mapping) else {})

    def get_field(self, field_name: str, args: Sequence[Any], kwargs: Mapping[str, Any]) -> Any:
        """A value by its name, which may have a dot in it; raises KeyError for what only Python means."""
        if "__" in field_name:
            raise KeyError(field_name)
        if field_name in kwargs:
            return kwargs[field_name], field_name
        return super().get_field(field_name if kwargs else f"0.{field_name}", args, kwargs)

    def format_field(self, value: Any, format_spec: str) -> str:
        """A value as text; raises ValueError for a form that would fill pages."""
        if re.search(r"\d{3}", format_spec):
            raise ValueError(f"the form {format_spec[:40]!r} is too wide")
        if format_spec in self.named:
            return self.named[format_spec](value)
        return formatted(value, format_spec) if format_spec else str(value)
