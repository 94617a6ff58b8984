"""A store that nobody vouches for: links, pipes, bombs and names that lead out of it are not followed or unpacked."""

from __future__ import annotations

import base64
import json
import os
import pickle
import re
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studies.gate.foreign import ClaimError, Foreign
from studies.gate.merge import VERIFIED, merge
from studies.run.archive import Archive
from support.stores.elsewhere import BEAM, FINE, STRIP, Elsewhere

pytestmark = pytest.mark.slow  # a store each

Plant = Callable[[Elsewhere, Path], object]


def outside(path: Path, tmp_path: Path) -> None:
    """The same content, but somewhere else."""
    path.rename(tmp_path / "outside")
    path.symlink_to(tmp_path / "outside")


def record_path(there: Elsewhere) -> Path:
    return there.archive.record_path(there.ids[BEAM])


def pipe(there: Elsewhere, tmp_path: Path) -> None:
    there.field(BEAM).unlink()
    os.mkfifo(there.field(BEAM))


def bomb(there: Elsewhere, tmp_path: Path) -> None:
    """16 MB of zeros in place of some hundred bytes, packed into a file of hardly more than it had."""
    packed = base64.b64encode(zlib.compress(bytes(2**24), 9))
    text = there.field(BEAM).read_bytes()
    pattern = rb'(Name="pressure"[^>]*>\n.{44})[^\n]*'
    there.field(BEAM).write_bytes(re.sub(pattern, lambda actual: actual[1] + packed, text))


class Trap:
    """Leaves a trace where it is unpickled."""

    def __init__(self, trace: Path) -> None:
        self.trace = trace

    def __reduce__(self) -> tuple[Any, ...]:
        return (Path.touch, (self.trace,))


def pickled(there: Elsewhere, tmp_path: Path) -> None:
    """In place of the field, and beside it under the name of an array."""
    data = pickle.dumps(Trap(tmp_path / "sprung"))
    there.field(BEAM).write_bytes(data)
    np.save(there.field(BEAM).with_name("u.npy"), np.array([Trap(tmp_path / "sprung")]), allow_pickle=True)


def named(name: str) -> Plant:
    return lambda there, tmp_path: there.falsify(BEAM, lambda stated: stated["files"].append(name))


def text_in_place_of(value: str, text: str) -> Plant:
    def change(there: Elsewhere, tmp_path: Path) -> None:
        path = record_path(there)
        path.write_text(re.sub(value, text, path.read_text(), count=1))

    return change


PLANTED: dict[str, tuple[Plant, str]] = {
    "a record that is a link": (lambda there, tmp: outside(record_path(there), tmp), "files: .* link"),
    "a field that is a link": (lambda there, tmp: outside(there.field(BEAM), tmp), "files: .* link"),
    "a folder that is a link": (lambda there, tmp: outside(there.field(BEAM).parent, tmp), "files: .* link"),
    "a pipe": (pipe, "files: .* not a regular file"),
    "a bomb": (bomb, "field: pressure has more than"),
    "a pickle": (pickled, "field: has the arrays of nothing"),
    "a file outside": (named("../../../secret.csv"), "files: must be"),
    "an array": (named("u.npy"), "files: must be"),
    "a table that is not there": (named("contact.csv"), "files: contact.csv is not there"),
    "NaN": (text_in_place_of('"total": [^,]*', '"total": NaN'), "record: .*NaN"),
    "infinity in digits": (text_in_place_of('"total": [^,]*', '"total": 1e999'), "record: .*1e999"),
    "a negative time": (
        text_in_place_of('"total": [^,]*', '"total": -1.0'),
        "record: .*timing_s.total = -1.0 must be a number of at least 0",
    ),
    "half a record": (text_in_place_of("(?s)\\{(.*)", "{"), "record: .*cannot be read"),
    "a depth without end": (text_in_place_of("(?s).*", "[" * 100_000), "record: .*it nests deeper"),
    "another schema": (lambda there, tmp: there.falsify(BEAM, lambda t: t.update(schema=1)), "record: .*has schema 1"),
    "a control sequence": (
        lambda there, tmp: there.falsify(BEAM, lambda t: t.update(reason="\x1b[2J")),
        "record: .*reason.* printed on one line",
    ),
    "no machine": (lambda there, tmp: there.falsify(BEAM, lambda t: t["provenance"].pop("machine")), "provenance"),
}


@pytest.mark.parametrize("name", PLANTED)
def test_what_no_honest_store_has_is_refused_and_the_rest_is_taken(
    name: str, elsewhere: Elsewhere, tmp_path: Path
) -> None:
    plant, said = PLANTED[name]
    plant(elsewhere, tmp_path)
    actual = merge(elsewhere.root, tmp_path / "here")
    (line,) = actual.refused
    assert re.match(rf"{BEAM} \(\w+\): {said}", line), line
    assert actual.counts == {VERIFIED: len(elsewhere.ids) - 1}
    assert not (tmp_path / "sprung").exists()


def test_nothing_but_what_a_record_names_is_taken(elsewhere: Elsewhere, tmp_path: Path) -> None:
    elsewhere.field(BEAM).with_name("more.csv").write_text("a\n1\n")
    merge(elsewhere.root, tmp_path / "here")
    folder = Archive(tmp_path / "here").files(elsewhere.ids[BEAM])
    assert sorted(path.name for path in folder.iterdir()) == ["fields.vtu", "history.csv"]


def test_a_file_beyond_its_size_is_not_read(elsewhere: Elsewhere) -> None:
    with pytest.raises(ClaimError, match="more than the 10 bytes that it may have"):
        Foreign(elsewhere.root).beside(elsewhere.ids[BEAM], "history.csv", 10)


def test_a_field_far_larger_than_its_mesh_is_not_read(elsewhere: Elsewhere, tmp_path: Path) -> None:
    with elsewhere.field(BEAM).open("ab") as file:
        file.truncate(2**30)
    (line,) = merge(elsewhere.root, tmp_path / "here").refused
    assert "fields.vtu: it has more than the" in line


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda row: row.update(options={"use": "evil.py"}), "asks for what no cell can ask for"),
        (lambda row: row.update(options={"mesh": 4}), "asks for what no cell can ask for"),
        (lambda row: row.update(label="a\nb"), "cells[0].label"),
        (lambda row: row.update(settings=[]), "cells[0].settings"),
    ],
)
def test_a_plan_that_none_of_ours_could_be_is_refused(
    change: Callable[[dict[str, Any]], None], said: str, elsewhere: Elsewhere, tmp_path: Path
) -> None:
    path = elsewhere.archive.index_path(elsewhere.campaign)
    plan = json.loads(path.read_text())
    change(plan["cells"][0])
    path.write_text(json.dumps(plan))
    actual = merge(elsewhere.root, tmp_path / "here")
    (line,) = actual.refused
    assert said in line
    assert not actual.counts


def test_a_scene_or_a_mesh_that_is_not_here_is_one_line(elsewhere: Elsewhere, tmp_path: Path) -> None:
    path = elsewhere.archive.index_path(elsewhere.campaign)
    plan = json.loads(path.read_text())
    rows = {row["label"]: row for row in plan["cells"]}
    rows[BEAM]["scene"], rows[FINE]["options"]["mesh"] = "nowhere", "1000x1000"
    path.write_text(json.dumps(plan))
    actual = merge(elsewhere.root, tmp_path / "here")
    assert len(actual.refused) == 2
    assert "scene 'nowhere' must be one of" in actual.refused[0]
    assert actual.counts == {VERIFIED: 4}
    assert Archive(tmp_path / "here").record_path(elsewhere.ids[STRIP]).exists()
