"""What a stranger may send: answers, problems, tables of other programs, campaigns, plans and records that do harm."""

from __future__ import annotations

import io
import json
import os
import struct
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from support.problems.contact_problems import known_step

MB = 2**20
DEEP, DEEP_OBJECT = "[" * 100_000, '{"a":' * 100_000
HUGE = "1" + "0" * 400
ESCAPE = "\x1b]0;owned\x07\x1b[31m"
SCRIPT = "<script>alert(2)</script><img src=x onerror=alert(1)>"
Write = Callable[[Path], object]  # of one file


def text(content: str) -> Write:
    return lambda path: path.write_text(content, encoding="utf-8", errors="surrogateescape")


def content(data: bytes) -> Write:
    return lambda path: path.write_bytes(data)


def sparse_file(size: int) -> Write:
    def write(path: Path) -> None:
        with path.open("wb") as file:
            file.truncate(size)

    return write


# --- arrays -------------------------------------------------------------------------------------------------------


def npy(array: Any) -> bytes:
    held = io.BytesIO()
    np.save(held, np.asarray(array))
    return held.getvalue()


def header(shape: str, descr: str = "<f8") -> bytes:
    """Of an array of which nothing is there."""
    stated = f"{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}".encode()
    stated += b" " * (-(len(stated) + 11) % 64) + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(stated)) + stated


def npz(members: Mapping[str, bytes], zeros: Mapping[str, int] | None = None) -> Write:
    """zeros: arrays of so many MB of them."""

    def write(path: Path) -> None:
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
            for name, data in members.items():
                archive.writestr(f"{name}.npy", data)
            for name, size in (zeros or {}).items():
                with archive.open(f"{name}.npy", "w") as file:
                    file.write(header(f"({size * MB // 8},)"))
                    for _ in range(size):
                        file.write(bytes(MB))

    return write


def encrypted(write: Write) -> Write:
    """The flag set in all members and in the list of members."""

    def changed(path: Path) -> None:
        write(path)
        data = bytearray(path.read_bytes())
        for mark, flag in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
            at = data.find(mark)
            while at >= 0:
                data[at + flag] |= 1
                at = data.find(mark, at + 4)
        path.write_bytes(data)

    return changed


STEP, DU, PRESSURE = known_step()
GOOD = {"du": DU.tolist(), "pressure": PRESSURE.tolist()}
ARRAYS = {"du": npy(DU), "pressure": npy(PRESSURE)}


def claiming(said: str) -> Write:
    return text(json.dumps(GOOD)[:-1] + f', "claims": {said}}}')


def step_with(**changes: Any) -> Write:
    """The frozen step with some of its members replaced."""

    def write(path: Path) -> None:
        STEP.write(path)
        with np.load(path) as arrays:
            members = {name: npy(arrays[name]) for name in arrays.files}
        npz({**members, **{name: each if isinstance(each, bytes) else npy(each) for name, each in changes.items()}})(
            path
        )

    return write


ANSWERS: dict[str, tuple[str, Write, str]] = {
    "a deep list": (".json", text(DEEP), "nests deeper"),
    "a deep object": (".json", text(DEEP_OBJECT), "nests deeper"),
    "a deep claim": (".json", claiming(f'{{"force": {"[" * 500 + "]" * 500}}}'), "nests deeper"),
    "a number without end": (".json", text(f'{{"du": [{HUGE}], "pressure": []}}'), "too large a whole number"),
    "a force without end": (".json", claiming(f'{{"force": {HUGE}}}'), "too large a whole number"),
    "5,000 digits": (".json", claiming(f'{{"force": {"9" * 5000}}}'), "too large a whole number"),
    "NaN": (".json", text('{"du": [NaN], "pressure": []}'), "not a finite number"),
    "infinity in digits": (".json", text('{"du": [1e999], "pressure": []}'), "not a finite number"),
    "no text": (".json", content(b"\xff\xfe\x00"), "decode"),
    "nothing": (".json", content(b""), "Expecting value"),
    "words for numbers": (".json", text('{"du": ["a"], "pressure": []}'), "could not convert"),
    "objects for numbers": (".json", text('{"du": [{}], "pressure": []}'), "is not an answer"),
    "ragged lists": (".json", text('{"du": [[1], [1, 2]], "pressure": []}'), "is not an answer"),
    "escapes in a claim": (".json", claiming(json.dumps({ESCAPE: 1})), r"claim '\\x1b\]0;owned"),
    "candidates below zero": (".json", claiming('{"pressed": [-1]}'), "pressed must be a list"),
    "5 million values": (".json", text(f'{{"du": [{"0," * 5_000_000}0], "pressure": []}}'), "more than 4000000 values"),
    "a file beyond all": (".json", sparse_file(2**40), "more than the 67108864 bytes"),
    "a pipe": (".json", os.mkfifo, "not a regular file"),
    "a pipe for arrays": (".npz", os.mkfifo, "not a regular file"),
    "10^12 numbers": (".npz", npz({**ARRAYS, "du": header("(1000000000000,)")}), "du declares the shape"),
    "10^40 numbers": (".npz", npz({**ARRAYS, "du": header(f"({10**40},)")}), "du declares the shape"),
    "a shape that does not end": (".npz", npz({**ARRAYS, "du": header("(((")}), "it is damaged"),
    "objects": (".npz", npz({**ARRAYS, "du": header("(1,)", "|O") + bytes(8)}), "only a pickle can hold"),
    "encrypted": (".npz", encrypted(npz(ARRAYS)), "du is encrypted"),
    "claims that nest": (".npz", npz({**ARRAYS, "claims": npy(DEEP)}), "nests deeper"),
    "claims that are numbers": (".npz", npz({**ARRAYS, "claims": npy(1.0)}), "claims must be one text"),
    "an array that unpacks to 300 MB": (".npz", npz({"du": ARRAYS["du"]}, {"pressure": 300}), "unpack to more than"),
}

PROBLEMS: dict[str, tuple[Write, str]] = {
    "meta that nests": (step_with(meta=DEEP), "nests deeper"),
    "meta that is no JSON": (step_with(meta="{"), "Expecting"),
    "meta that is not a text": (step_with(meta=1.0), "meta must be one text"),
    "meta with a number without end": (step_with(meta=f'{{"format": {HUGE}}}'), "too large a whole number"),
    "a residual of 10^12": (step_with(r=header("(1000000000000,)")), "r declares the shape"),
    "a negative shape": (step_with(r=header("(-1, -8)") + bytes(64)), "r declares the shape"),
    "scale as a word": (step_with(scale="big"), "scale must be one force"),
    "weights of objects": (step_with(weights=header("(1,)", "|O") + bytes(8)), "only a pickle can hold"),
    "indices beyond the matrix": (step_with(K_indices=STEP.K.indices + 10**6), "K is no"),
    "offsets below zero": (step_with(K_indptr=STEP.K.indptr - 5), "K is no"),
    "encrypted": (encrypted(step_with()), "is encrypted"),
    "members without end": (npz({f"member{i:06d}": b"" for i in range(5000)}), "list of members"),
    "no zip": (content(b"PK\x05\x06" + bytes(18) + b"not"), "not a frozen contact step"),
    "half a zip": (lambda path: (STEP.write(path), path.write_bytes(path.read_bytes()[:400])), "end is missing"),
    "a file beyond all": (sparse_file(2**40), "more than the 536870912"),
}

# --- tables and decks of other programs ---------------------------------------------------------------------------

BLOCK = " displacements (vx,vy,vz) for set BODY and time  {0}\n\n         1  1.0  0.0  {1}\n"
FIELD = "load_fraction,node,ux_mm,uy_mm,uz_mm\n"
RESULTS: dict[str, tuple[str, Write, str]] = {
    "time nan": (".dat", text(BLOCK.format("nan", "0.0")), "no finite numbers .* at time nan"),
    "time inf": (".dat", text(BLOCK.format("inf", "0.0")), "no finite numbers .* at time inf"),
    "a displacement that is none": (".dat", text(BLOCK.format("1.0", "-inf")), "breaks within|no finite numbers"),
    "a displacement beyond all": (".dat", text(BLOCK.format("1.0", "1e999")), "no finite numbers"),
    "a step beyond all": (".dat", text(BLOCK.format("1e300", "0.0")), "has no results"),
    "escapes for a set": (".dat", text(BLOCK.format(ESCAPE, "0.0")), "breaks within"),
    "escapes for a column": (".csv", text(f"{ESCAPE},b\n1,2\n"), r"it has \\x1b\]0;owned"),
    "loads that are none": (".csv", text("load_fraction,force_N\nnan,1\n"), "must be finite numbers"),
    "a load without end": (".csv", text(f"load_fraction,force_N\n{HUGE},1\n"), "not a table of numbers|must be finite"),
    "a node that is none": (".csv", text(FIELD + "1,nan,0,0,0\n"), "whole number in"),
    "a node beyond all": (".csv", text(FIELD + "1,1e300,0,0,0\n"), "whole number in"),
    "words": (".csv", text("load_fraction,force_N\n1,big\n"), "not a table of numbers"),
    "a million columns": (".csv", text("a," * 1_000_000 + "b\n"), "columns"),
    "5 million values": (".csv", text("load_fraction,b\n" + "1,2\n" * 10 + "," * 5_000_000), "columns, 50000"),
    "more loads than anyone solves": (
        ".csv",
        text("load_fraction,force_N\n" + "".join(f"{i / 2000},1\n" for i in range(1, 1500))),
        "more than 1000",
    ),
    "nothing": (".csv", content(b""), "not a table of numbers"),
    "zeros": (".csv", content(bytes(1000)), "no table of numbers|no column"),
    "a pipe": (".csv", os.mkfifo, "not a regular file"),
}
LCPS: dict[str, tuple[Write, str]] = {
    "a size beyond all": (text("1000000000 0 1000000000 1000000000 1000000000 1000000000 1"), "more than 4000000"),
    "a size without end": (text("9" * 5000 + " 0"), "not a linear complementarity problem"),
    "a size below zero": (text("-3 0 -3 -3 -3 -3"), "n = -3"),
    "NaN": (text("1 0 1 1 1 1 nan 1"), "finite numbers"),
    "escapes": (text(f"{ESCAPE} 0"), r"\\x1b"),
    "nothing": (content(b""), "not a linear complementarity problem"),
}

# --- campaigns ----------------------------------------------------------------------------------------------------

MANY = ", ".join(f"k{i} = [1, 2, 3, 4]" for i in range(9))
CAMPAIGNS: dict[str, tuple[str, str]] = {
    "a deep list": (f"lists = {'[' * 20_000}", "nests deeper"),
    "a deep name": (".".join("a" * 20_000) + " = 1", "nests deeper"),
    "a deep table": ("cross = " + "{a=" * 5000, "nests deeper"),
    "a number for a cross": ("cross = 1", "must be a list"),
    "a number for a module": ("modules = [1]", "must be a text"),
    "a number for a scene": ("cross = [{scenes = {panel = 1}}]", "must be a set of values"),
    "a list for a list": ("lists = [[]]", "must be a list of numbers or words"),
    "a number for a title": ("title = 1", "must be a text"),
    "escapes for a title": (r'title = "\u001B]0;owned"', r"printed on one line"),
    "escapes for a name": (r'cross = [{name = "\u001B[31m", scenes = {}}]', "printed on one line"),
    "escapes for a key": (r'"\u001B[31m" = 1', r"key '\\x1b\[31m' must be"),
    "a date for a setting": ("cross = [{set = {a = 1979-05-27}, scenes = {}}]", "must be a word"),
    "an axis within an axis": ("cross = [{vary = {a = [[1]]}, scenes = {}}]", "must be a list of numbers"),
    "more cells than anyone solves": (f"[[cross]]\nvary = {{ {MANY} }}\n[cross.scenes.tyre]", "exceeds a limit"),
    "labels without end": (f'[[cross]]\nvary.a = ["{"x" * 8000}"]\n[cross.scenes.tyre]', "exceeds a limit"),
    "a file beyond its size": ("#" * (MB // 2), "more than the"),
    "a module outside": ('modules = ["../beside"]', "name of a module beside it"),
    "a module by its path": ('modules = ["/tmp/beside"]', "name of a module beside it"),
    "a module that nobody trusts": ('modules = ["beside"]', "allow this by footprint run --trust"),
    "a module that is a link": ('modules = ["linked"]', "leads out of the folder"),
}

# --- stores -------------------------------------------------------------------------------------------------------

Change = Callable[[dict[str, Any]], object]
RECORDS: dict[str, tuple[Change | str, str]] = {
    "a deep record": (DEEP, "nests deeper"),
    "half a record": ('{"schema": 2', "cannot be read"),
    "a time without end": (lambda r: r["timing_s"].update(cpu=10**400), "too large a whole number"),
    "a quantity without end": (lambda r: r["quantities"].update(tip_deflection_mm=10**400), "too large"),
    "a step without end": (lambda r: r["steps"][0].update(load_fraction=10**400), "too large a whole number"),
    "a time that is none": (lambda r: r["timing_s"].update(cpu=None), "timing_s.cpu"),
    "a time below zero": (lambda r: r["timing_s"].update(cpu=-1.0), "timing_s.cpu"),
    "no quantities": (lambda r: r.update(quantities=None), "quantities"),
    "a word for steps": (lambda r: r.update(steps="x"), "steps"),
    "a list for counters": (lambda r: r.update(counters=[1]), "counters"),
    "words for failures": (lambda r: r["steps"][0].update(failures="x"), "failures"),
    "a number for a reason": (lambda r: r.update(reason=1), "reason"),
    "escapes for a reason": (lambda r: r.update(reason=ESCAPE), "reason"),
    "a reason of two lines": (lambda r: r.update(reason="a\nmerge: all verified"), "reason"),
    "a reason without end": (lambda r: r.update(reason="x" * 10_000), "reason"),
    "a name that is an escape": (lambda r: r["quantities"].update({ESCAPE: 1.0}), "printed on a line|name"),
    "a mark that turns text": (lambda r: r.update(reason="\u202etxt"), "reason"),
    "a path for an identity": (lambda r: r.update(id="../../x"), "id|is of"),
    "a number for provenance": (lambda r: r.update(provenance=1), "provenance"),
}
ODD: dict[str, Change] = {  # each value is of its type
    "no outcome": lambda r: r.pop("outcome"),
    "a mesh that is none": lambda r: r.update(mesh="x"),
    "no settings": lambda r: r["settings"].clear(),
    "no loads": lambda r: r["steps"].clear(),
    "a load without anything": lambda r: r.update(steps=[{}]),
    "no provenance": lambda r: r.update(provenance={}),
    "no machine": lambda r: r["provenance"].clear(),
    "quantities beyond all": lambda r: r["quantities"].update(dict.fromkeys(r["quantities"], 1e308)),
    "words for quantities": lambda r: r["steps"][-1].update(tip_deflection_mm="far"),
    "merged from nowhere": lambda r: r.update(merged={}),
    "another scene": lambda r: r.update(scene="nowhere"),
}
PLANS: dict[str, tuple[Change | str, str]] = {
    "a deep plan": (DEEP, "nests deeper"),
    "a number for cells": (lambda p: p.update(cells=1), "cells|none of schema"),
    "a number for a cell": (lambda p: p.update(cells=[1]), "cells|a row of it is none"),
    "a cell without anything": (lambda p: p.update(cells=[{}]), "lacks|no label"),
    "escapes for a label": (lambda p: p["cells"][0].update(label=ESCAPE), "label"),
    "a label of two lines": (lambda p: p["cells"][0].update(label="a\nb"), "label"),
    "a path for an identity": (lambda p: p["cells"][0].update(id="../../../etc/passwd"), "id|identity"),
    "a list for settings": (lambda p: p["cells"][0].update(settings=[]), "settings"),
    "escapes for a setting": (
        lambda p: p["cells"][0]["settings"].update(load_fraction=ESCAPE),
        "set|load_fraction|no cell can ask for",
    ),
    "another schema": (lambda p: p.update(schema=[1]), "schema"),
}


def changed(path: Path, change: Change | str) -> None:
    """A file of JSON, replaced or changed."""
    if isinstance(change, str):
        path.write_text(change)
        return
    record = json.loads(path.read_text())
    change(record)
    path.write_text(json.dumps(record))
