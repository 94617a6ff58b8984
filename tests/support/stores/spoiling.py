"""What is spoilt of files from elsewhere: bits, types, depth, sizes of numbers, control characters, markup.

Pure functions of valid content and a generator. Who reads the spoilt content, and what may come of it, does not enter.
"""

from __future__ import annotations

import io
import json
import re
from collections.abc import Iterator
from typing import Any

import numpy as np

DEPTH = 100_000
MARKUP = (
    "<script>alert(2)</script>",
    "<img src=x onerror=alert(1)>",
    "![p](http://evil.example/p.png)",
    "see [click](http://evil.example/)",
    "[x](javascript:alert(1))",
    "| a | b |\n|---|---|\n| <svg onload=alert(1)> |",
    "&#60;script&#62;alert(3)&#60;/script&#62;",
    "</code></td><script>alert(4)</script>",
    "<!-- --><iframe src=//evil.example>",
)
CONTROL = ("\x1b[2J\x1b[31mred", "\x00", "a\rb", "a\nb\n\nc", "\u202eeman", "\x9b31m", "\x7f\x08\x08", "\ud800")
TEXTS = (*MARKUP, *CONTROL, "", "x" * 100_000, "../../etc/passwd", "/etc/passwd", "nan", "-0")
RAW = (  # of JSON, as it is written
    *("null", "true", "[]", "{}", "-1", "0", "1e400", "NaN", "Infinity", "-Infinity", "1" + 400 * "0", "[[[]]]"),
    *('{"a": 1}', "[1]", "0.5", '["x"]', "[" * DEPTH + "]" * DEPTH, '{"a":' * DEPTH + "1" + "}" * DEPTH),
)
TOML = (  # values of TOML, as they are written
    *("true", "[]", "{}", "-1", "1e400", "nan", "inf", "1" + 400 * "0", "[[]]", "[1]", "1979-05-27", '""', '["../x"]'),
    *("{panel=1}", "[" * DEPTH + "]" * DEPTH, "{a=" * 1000 + "1" + "}" * 1000, '"\\u001b[2J"'),
)
_HOLE = "\N{OBJECT REPLACEMENT CHARACTER}"


def json_text(data: Any, rng: np.random.Generator) -> str:
    """A valid document with one value, or one key, that is not what it should be."""
    copy = json.loads(json.dumps(data))
    places = list(_places(copy))
    where, key = places[rng.integers(len(places))]
    how = rng.random()
    if how < 0.15 and isinstance(where, dict):
        where[TEXTS[rng.integers(len(TEXTS))]] = where.pop(key)
    elif how < 0.25:
        del where[key]
    elif how < 0.6:
        where[key] = TEXTS[rng.integers(len(TEXTS))]
    else:
        where[key] = _HOLE
    return json.dumps(copy).replace(json.dumps(_HOLE), RAW[rng.integers(len(RAW))])


def _places(data: Any) -> Iterator[tuple[Any, Any]]:
    """Every value in a document by what holds it and its key there."""
    for key, value in list(data.items()) if isinstance(data, dict) else list(enumerate(data)):
        yield data, key
        if isinstance(value, dict | list):
            yield from _places(value)


def toml_text(text: str, rng: np.random.Generator) -> str:
    """A valid document with one value that is not what it should be, or some bytes of it."""
    if rng.random() < 0.2:
        return flipped(text.encode(), rng).decode("utf-8", "replace")
    values = list(re.finditer(r"(?<== ).+$", text, re.MULTILINE))
    at = values[rng.integers(len(values))]
    strange = TEXTS[rng.integers(len(TEXTS))].encode("utf-8", "replace").decode()
    value = json.dumps(strange) if rng.random() < 0.3 else TOML[rng.integers(len(TOML))]
    return text[: at.start()] + value + text[at.end() :]


def flipped(data: bytes, rng: np.random.Generator) -> bytes:
    """Some bits turned, or an end cut off."""
    if rng.random() < 0.3:
        return data[: rng.integers(len(data))]
    actual = bytearray(data)
    for at in rng.integers(len(data), size=int(rng.integers(1, 9))):
        actual[at] ^= 1 << int(rng.integers(8))
    return bytes(actual)


def npz(data: bytes, rng: np.random.Generator) -> bytes:
    """A valid file of arrays with one of another type, shape or content, or some bits turned."""
    if rng.random() < 0.4:
        return flipped(data, rng)
    with np.load(io.BytesIO(data)) as read:
        arrays = {name: read[name] for name in read.files}
    name = sorted(arrays)[rng.integers(len(arrays))]
    old = arrays[name]
    others: tuple[Any, ...] = (
        *(old.astype(str), old[..., None], np.zeros(0), np.array(np.nan), np.array(TEXTS[rng.integers(len(TEXTS))])),
        *(np.array(RAW[rng.integers(len(RAW))]), np.array([None, {}], object), np.full(old.shape, -(2**62))),
        *(np.full(old.shape, np.inf), np.zeros(10**6), np.zeros((3, 0, 2)), np.array(b"\xff\xfe"), old.repeat(2)),
    )
    arrays[name] = others[rng.integers(len(others))]
    if rng.random() < 0.1:
        arrays[TEXTS[rng.integers(len(MARKUP))]] = old
    file = io.BytesIO()
    np.savez_compressed(file, **arrays)
    return file.getvalue()
