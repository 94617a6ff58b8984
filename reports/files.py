"""Files: texts onto the disk, by a temporary name and a rename, so that no reader sees half a page.

JSON and CSV files of a store, read and checked; whatever is wrong with one ends in a StoreError of one line.

Text of others becomes text of pages here, once: what Markdown or HTML would take for its own is given by its number.
"""

from __future__ import annotations

import gzip
import json
import os
import re
import tempfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd


def write_texts(directory: Path, texts: Mapping[str, str]) -> list[Path]:
    """Write texts by their names relative to ``directory``; returns the paths in the order given."""
    for name, text in texts.items():
        _write(directory / name, text)
    return [directory / name for name in texts]


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    descriptor, name = tempfile.mkstemp(dir=path.parent, prefix=".part-", suffix=path.suffix)
    temporary = Path(name)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(as_bytes(path.name, text))
        temporary.chmod(0o644)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def as_bytes(name: str, text: str) -> bytes:
    """What a file of this name holds."""
    return gzip.compress(text.encode(), mtime=0) if name.endswith(".gz") else text.encode()


SCHEMA = 2
HTML = r"<(?=[A-Za-z/!?])|!(?=\[)|\](?=[(\[])"  # with links and pictures
PLACES = r"(?m:^[\s>*+\-\d.)]*\[)(?=[^\]]*\]:)"  # of links, by name
LINKED = r"(?<=[a-z]):(?=//)|(?<=www)\.|(?<=\w)@(?=\w)|(?<!\w)@(?=\w)"  # what GitHub makes links of by itself
NAMED = r"&(?=#?\w+;)"  # characters by their names
LIVE = re.compile(
    rf"{HTML}|{PLACES}|{LINKED}|{NAMED}"
    r"|[|`$~\\*]|(?<![^\W_])_|_(?![^\W_])"  # columns, code, formulas, fences, escapes, emphasis
    r"|^\s*[#>]"  # headings, quotes
)
LIVE_IN_PROSE = re.compile(rf"{HTML}|{PLACES}|{LINKED}|{NAMED}|[$~]")


class StoreError(ValueError):
    """A store that cannot be reported; its message is the one line the user reads."""


def read_table(path: Path, columns: Iterable[str] = (), prose: Iterable[str] = ()) -> pd.DataFrame:
    """A CSV file with at least these columns; raises StoreError when it is missing or damaged.

    prose: columns of whole sentences, which have code and emphasis in them.
    """
    table = _read(path, lambda: pd.read_csv(path))
    table.columns = [as_words(str(name)) for name in table.columns]
    for name in table.columns:
        if table[name].dtype.kind == "O":  # texts, be they of pandas' own type or of Python's
            shown = as_prose if name in prose else as_words
            worded = table[name].map(lambda value, shown=shown: shown(value) if isinstance(value, str) else value)
            table[name] = worded.astype(table[name].dtype)
    missing = [column for column in columns if column not in table]
    if missing:
        raise StoreError(f"{path}: lacks the columns {', '.join(missing)}")
    return table


def read_record(path: Path, keys: Iterable[str]) -> dict[str, Any]:
    """A JSON file with at least these keys; raises StoreError when it is missing or damaged."""
    data = _read(path, lambda: json.loads(path.read_text(encoding="utf-8")))
    require(data, keys, path)
    return dict(_worded(data))


def read_versioned(path: Path, keys: Iterable[str]) -> dict[str, Any]:
    """As read_record, of this schema."""
    data = read_record(path, ("schema",))
    if data["schema"] != SCHEMA:
        raise StoreError(f"{path}: schema {data['schema']!r}, but this program reads {SCHEMA}")
    require(data, keys, path)
    return data


def _worded(data: Any) -> Any:
    """The same with texts that mean themselves on a page."""
    if isinstance(data, dict):
        return {as_words(key): _worded(value) for key, value in data.items()}
    if isinstance(data, list):
        return [_worded(value) for value in data]
    return as_words(data) if isinstance(data, str) else data


def require(data: object, keys: Iterable[str], path: Path) -> None:
    """Raises StoreError for what is not a record, or lacks a key."""
    if not isinstance(data, Mapping):
        raise StoreError(f"{path}: expected a record, found {type(data).__name__}")
    missing = [key for key in keys if key not in data]
    if missing:
        raise StoreError(f"{path}: lacks {', '.join(missing)}")


def _read(path: Path, reader: Callable[[], Any]) -> Any:
    try:
        return reader()
    except FileNotFoundError:
        raise StoreError(f"{path}: missing") from None
    except (OSError, ValueError) as error:
        raise StoreError(f"{path}: cannot be read: {' '.join(str(error).split())}") from None


def as_words(text: str) -> str:
    """A text on one line that means itself in Markdown: characters that would do something are given by their numbers.

    Numbers, units and names of ours stay as they are.
    """
    return LIVE.sub(_numbered, text if text.isprintable() else _printable(" ".join(text.split())))


def as_prose(text: str) -> str:
    """A text whose code, emphasis and paragraphs stay; links, pictures, formulas and HTML are written out."""
    return LIVE_IN_PROSE.sub(_numbered, "\n".join(map(_printable, text.split("\n"))))


def _printable(line: str) -> str:
    """A line whose other characters are as Python writes them."""
    return "".join(letter if letter.isprintable() else letter.encode("unicode_escape").decode() for letter in line)


def _numbered(match: re.Match[str]) -> str:
    return "".join(f"&#{ord(letter)};" for letter in match[0])
