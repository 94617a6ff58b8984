"""Files that nobody vouches for: JSON, TOML and arrays, read within bounds of size, depth and number.

Whatever a file says of itself is checked before what it asks for is made: how long it is, how deep it nests, how many
values it has, which shape and type an array declares. Nothing is unpickled. What the values mean does not enter here.
"""

from __future__ import annotations

import json
import math
import os
import re
import stat
import struct
import tokenize
import tomllib
import zipfile
import zlib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

MB = 2**20
LARGEST = 64 * MB  # bytes of a text
LARGEST_TOML = MB // 4
LARGEST_ARRAYS = 256 * MB  # all that are read of one file, unpacked
LARGEST_PACKED = 512 * MB
LARGEST_INDEX = MB // 4  # of a zip: names and places of its members
MOST = 4_000_000  # values of a text: each takes up to 250 bytes
DEEPEST = 40
LARGEST_WHOLE = 2**63
DOTTED = re.compile(  # a key of TOML with more names than that: to read it takes their number squared
    rf"(?<![\w-])(?:(?:[\w-]++|\"[^\"\n]*+\"|'[^'\n]*+')[ \t]*+\.[ \t]*+){{{DEEPEST}}}"
)
KINDS = "fiuU"  # of arrays: numbers and text
DAMAGED = (  # what readers of a zip and of the header of an array raise beside ValueError
    *(zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, struct.error),
    *(SyntaxError, tokenize.TokenError, RecursionError),
)
END, END_64 = b"PK\x05\x06", b"PK\x06\x07"  # of a zip, and of one that counts beyond 32 bits


def read_bytes(path: Path, largest: int = LARGEST) -> bytes:
    """A regular file of at most so many bytes; raises ValueError, and OSError where it cannot be opened."""
    with _opened(path) as file:
        data = file.read(largest + 1)
    if len(data) > largest:
        raise ValueError(f"it has more than the {largest} bytes that it may have")
    return data


@contextmanager
def _opened(path: Path) -> Iterator[IO[bytes]]:
    """A regular file; raises ValueError for anything else: a pipe must not hold us up."""
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise ValueError("it is not a regular file")
    with os.fdopen(descriptor, "rb") as file:
        yield file


def parsed_json(data: bytes | str) -> Any:
    """The value of a JSON text, whose numbers are finite and whose whole numbers have 64 bits; raises ValueError."""
    text = data if isinstance(data, str) else data.decode("utf-8")
    if sum(map(text.count, ",[{")) > MOST:
        raise ValueError(f"it has more than {MOST} values")
    try:
        parsed = json.loads(text, parse_float=_finite, parse_int=_whole, parse_constant=_finite)
    except RecursionError:
        raise ValueError(f"it nests deeper than {DEEPEST} levels") from None
    return _shallow(parsed)


def read_json(path: Path, largest: int = LARGEST) -> Any:
    """The value in a file of JSON; raises ValueError, and OSError where it cannot be opened."""
    return parsed_json(read_bytes(path, largest))


def read_toml(path: Path) -> dict[str, Any]:
    """The table in a file of TOML; raises ValueError, and OSError where it cannot be opened."""
    text = read_bytes(path, LARGEST_TOML).decode("utf-8-sig")  # editors of some systems begin with a byte-order mark
    if DOTTED.search(text):
        raise ValueError(f"it nests deeper than {DEEPEST} levels")
    try:
        return dict(_shallow(tomllib.loads(text)))
    except RecursionError:
        raise ValueError(f"it nests deeper than {DEEPEST} levels") from None


def _finite(word: str) -> float:
    value = float(word)
    if not math.isfinite(value):
        raise ValueError(f"{word[:40]} is not a finite number")
    return value


def _whole(word: str) -> int:
    if len(word) > len(str(LARGEST_WHOLE)) + 1 or abs(int(word)) >= LARGEST_WHOLE:
        raise ValueError(f"{word[:40]} is too large a whole number")
    return int(word)


def _shallow(data: Any) -> Any:
    """The same; raises ValueError where it nests deeper than DEEPEST."""
    level = [data]
    for _ in range(DEEPEST):
        inside = (each.values() if isinstance(each, dict) else each for each in level if isinstance(each, dict | list))
        level = [value for values in inside for value in values if isinstance(value, dict | list)]
        if not level:
            return data
    raise ValueError(f"it nests deeper than {DEEPEST} levels")


def read_arrays(path: Path, wanted: Iterable[str], optional: Iterable[str] = ()) -> dict[str, np.ndarray]:
    """These arrays of a .npz, and the optional ones that it has; what else is in it is not unpacked.

    Raises ValueError naming what is missing or wrong, KeyError's text included, and OSError where it cannot be opened.
    """
    with _opened(path) as file:
        _check_container(file)
        try:
            with zipfile.ZipFile(file) as archive:
                return _arrays(archive, tuple(wanted), tuple(optional))
        except DAMAGED as error:
            raise ValueError(f"it is damaged: {(str(error) or type(error).__name__).splitlines()[0]}") from None


def _check_container(file: IO[bytes]) -> None:
    """Raises ValueError for what is not a zip, or whose list of members alone would fill the memory."""
    size = file.seek(0, os.SEEK_END)
    if size > LARGEST_PACKED:
        raise ValueError(f"it has {size} bytes, more than the {LARGEST_PACKED} that it may have")
    file.seek(max(0, size - 2**16 - 42))
    tail = file.read()
    at = tail.rfind(END)
    if not zipfile.is_zipfile(file) or at < 0 or len(tail) < at + 22:
        raise ValueError("it is no .npz file, or its end is missing")
    (index,) = struct.unpack("<L", tail[at + 12 : at + 16])
    if index > LARGEST_INDEX or END_64 in tail:
        raise ValueError(f"its list of members is longer than {LARGEST_INDEX} bytes")


def _arrays(archive: zipfile.ZipFile, wanted: tuple[str, ...], optional: tuple[str, ...]) -> dict[str, np.ndarray]:
    members = {each.filename.removesuffix(".npy"): each for each in archive.infolist()}
    missing = [name for name in wanted if name not in members]
    if missing:
        raise ValueError(f"{missing[0]} is missing")
    asked = {name: members[name] for name in (*wanted, *optional) if name in members}
    if sum(each.file_size for each in asked.values()) > LARGEST_ARRAYS:
        raise ValueError(f"its arrays unpack to more than {LARGEST_ARRAYS} bytes")
    return {name: _array(archive, member, name) for name, member in asked.items()}


def _array(archive: zipfile.ZipFile, member: zipfile.ZipInfo, name: str) -> np.ndarray:
    """One array, made when its header, the size of the member and what is in it agree."""
    import numpy as np
    from numpy.lib import format as npy

    if member.flag_bits & 1:
        raise ValueError(f"{name} is encrypted")
    with archive.open(member) as file:
        read = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}.get(npy.read_magic(file))
        if read is None:
            raise ValueError(f"{name} is an array of a later format")
        shape, fortran, dtype = read(file)
        if dtype.kind not in KINDS or dtype.fields is not None or dtype.itemsize == 0:
            what = "objects, which only a pickle can hold" if dtype.hasobject else f"the type {dtype}"
            raise ValueError(f"{name} has {what}: numbers or text are read")
        size = math.prod(shape) * dtype.itemsize
        if min(shape, default=0) < 0 or size != member.file_size - file.tell():
            raise ValueError(f"{name} declares the shape {str(shape)[:80]}, which its size does not bear out")
        data = file.read(size)
        if len(data) != size or file.read(1):
            raise ValueError(f"{name} is cut off")
    values = np.frombuffer(bytearray(data), dtype)
    return values.reshape(shape, order="F" if fortran else "C")


def text_of(array: np.ndarray, name: str) -> str:
    """The text that an array of one entry holds; raises ValueError."""
    if array.dtype.kind != "U" or array.size != 1 or array.nbytes > MB:
        raise ValueError(f"{name} must be one text")
    return str(array.reshape(())[()])


def parsed_object(text: str, name: str) -> Mapping[str, Any]:
    """The object that a JSON text is; raises ValueError."""
    value = parsed_json(text)
    if not isinstance(value, dict):
        raise ValueError(f"{name} must be a JSON object")
    return value
