"""Files of strangers: what a file says of itself is checked before anything is made of it."""

import io
import json
import struct
import tracemalloc
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from contact.interchange import untrusted
from contact.interchange.untrusted import MB, parsed_json, read_arrays, read_bytes, read_toml


def npy(array: np.ndarray) -> bytes:
    held = io.BytesIO()
    np.save(held, array)
    return held.getvalue()


def header(shape: str, descr: str = "<f8") -> bytes:
    """Of an array of which nothing is there."""
    text = f"{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}".encode()
    text += b" " * (-(len(text) + 11) % 64) + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text


def zipped(path: Path, **members: bytes) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(f"{name}.npy", data)
    return path


def encrypted(path: Path) -> Path:
    """The flag set in the member and in the list of members."""
    data = bytearray(zipped(path, a=npy(np.ones(3))).read_bytes())
    data[6] |= 1
    data[data.find(b"PK\x01\x02") + 8] |= 1
    path.write_bytes(data)
    return path


WRONG: dict[str, tuple[Callable[[Path], Path], str]] = {
    "encrypted": (encrypted, "a is encrypted"),
    "a shape of 10^12": (lambda p: zipped(p, a=header("(1000000000000,)")), "declares the shape"),
    "a shape of 10^40": (lambda p: zipped(p, a=header(f"({10**40},)")), "declares the shape"),
    "a negative shape": (lambda p: zipped(p, a=header("(-1, -8)") + bytes(64)), "declares the shape"),
    "more than its shape": (lambda p: zipped(p, a=npy(np.ones(3)) + bytes(8)), "declares the shape"),
    "nothing in it": (lambda p: zipped(p, a=header("(0,)", "<V0")), "the type"),
    "records": (lambda p: zipped(p, a=npy(np.zeros(2, "i4,f8"))), "the type"),
    "objects": (lambda p: zipped(p, a=header("(1,)", "|O") + bytes(8)), "only a pickle can hold"),
    "no header": (lambda p: zipped(p, a=b"nothing"), "magic"),
    "a header that is code": (lambda p: zipped(p, a=header("__import__('os')")), "Cannot parse|malformed"),
    "missing": (lambda p: zipped(p, b=npy(np.ones(3))), "a is missing"),
}


def test_an_array_that_is_not_what_it_says_is_refused(tmp_path: Path) -> None:
    for name, (make, said) in WRONG.items():
        with pytest.raises(ValueError, match=said) as caught:
            read_arrays(make(tmp_path / f"{name}.npz"), ["a"])
        assert "\n" not in str(caught.value)


def test_what_is_not_asked_for_is_not_unpacked(tmp_path: Path) -> None:
    """32 MB beside three numbers."""
    path = tmp_path / "bomb.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.npy", npy(np.arange(3.0)))
        with archive.open("more.npy", "w", force_zip64=True) as file:
            for _ in range(32):
                file.write(bytes(MB))
    tracemalloc.start()
    assert np.array_equal(read_arrays(path, ["a"], ["b"])["a"], [0, 1, 2])
    assert tracemalloc.get_traced_memory()[1] < 4 * MB
    tracemalloc.stop()


def test_a_bomb_that_is_asked_for_is_refused_by_its_declared_size(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(untrusted, "LARGEST_ARRAYS", 1000)
    with pytest.raises(ValueError, match="unpack to more than 1000 bytes"):
        read_arrays(zipped(tmp_path / "a.npz", a=npy(np.zeros(1000))), ["a"])


def test_a_list_of_members_without_end_is_refused(tmp_path: Path) -> None:
    path = zipped(tmp_path / "a.npz", **{f"member{i:06d}": b"" for i in range(5000)})
    with pytest.raises(ValueError, match="list of members"):
        read_arrays(path, ["a"])


def test_arrays_come_back_as_they_were(tmp_path: Path, rng: np.random.Generator) -> None:
    kept: dict[str, Any] = {"a": rng.random((3, 4)), "b": np.asfortranarray(rng.random((3, 4)))}
    kept |= {"c": np.array("text"), "d": np.zeros(0)}
    np.savez_compressed(tmp_path / "a.npz", **kept)
    for name, array in read_arrays(tmp_path / "a.npz", kept).items():
        assert array.dtype == kept[name].dtype
        assert np.array_equal(array, kept[name])
        assert array.flags.writeable


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[" * 100_000, "nests deeper"),
        ("[" * 50 + "]" * 50, "nests deeper"),
        ('{"a":' * 300 + "1" + "}" * 300, "nests deeper"),
        ("1" + "0" * 400, "too large a whole number"),
        ("9" * 5000, "too large a whole number"),
        ("1e999", "not a finite number"),
        ("[NaN]", "not a finite number"),
        ("-Infinity", "not a finite number"),
        ("{", "Expecting"),
    ],
)
def test_json_beyond_its_bounds_is_refused_in_a_line(text: str, said: str) -> None:
    with pytest.raises(ValueError, match=said) as caught:
        parsed_json(text)
    assert "\n" not in str(caught.value)


def test_json_with_more_values_than_fit_is_not_parsed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(untrusted, "MOST", 10)
    with pytest.raises(ValueError, match="more than 10 values"):
        parsed_json(json.dumps([0] * 12))
    assert parsed_json(json.dumps([[1, 2.5, "a", None, True, {}]])) == [[1, 2.5, "a", None, True, {}]]


def test_only_regular_files_of_their_size_are_read(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(bytes(11))
    assert read_bytes(tmp_path / "a", 11) == bytes(11)
    with pytest.raises(ValueError, match="more than the 10 bytes"):
        read_bytes(tmp_path / "a", 10)
    with pytest.raises(ValueError, match="not a regular file"):
        read_bytes(Path("/dev/zero"))


@pytest.mark.parametrize("text", ["a=" + "[" * 20_000, ".".join("a" * 20_000) + "=1", f"a={'{a=' * 5000}"])
def test_toml_that_nests_without_end_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text(text)
    with pytest.raises(ValueError, match="nests deeper"):
        read_toml(tmp_path / "a.toml")


def test_toml_may_begin_with_a_byte_order_mark(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_bytes(b"\xef\xbb\xbfa = 1\n")
    assert read_toml(tmp_path / "a.toml") == {"a": 1}
