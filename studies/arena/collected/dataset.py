"""The collection as a data set for others: its identity, its splits, a card, and checksums of the files as shipped.

The identity is a hash of both manifests: another choice of problems, or other sums of one, is another collection.
Checksums are of the files as written on one machine; regenerated on another they differ in their last digits, and the
manifests decide whether they are the same problems.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from string import Template

import pandas as pd

from studies.arena.collected.collection import HERE, LICENCE, TEST, TUNE, VERSION, kept_names
from studies.arena.collected.frictional import FRICTIONAL
from studies.arena.collected.rule import STEPS
from studies.output.atomic import write_text

CARD, CHECKSUMS = "README.md", "SHA256SUMS"
LINE = re.compile(r"([0-9a-f]{64})  ([^/\\\0]+\.npz)")


@cache
def identity() -> str:
    """Of the collection: 16 digits of a hash of its version and its manifests."""
    digest = hashlib.sha256(f"{VERSION}\n".encode())
    for each in (STEPS, FRICTIONAL):
        digest.update(HERE.joinpath(each.manifest_file).read_bytes())
    return digest.hexdigest()[:16]


def write_card(directory: Path) -> None:
    """Write the card and the checksums of all files of the manifests beside them."""
    names = _names()
    text = "".join(f"{_digest(directory / f'{name}.npz')}  {name}.npz\n" for name in names)
    write_text(directory / CHECKSUMS, text)
    write_text(directory / CARD, card())


def card() -> str:
    """The card: contents, intended use, splits, licences, and checks of the data set."""
    smooth, rubbed = STEPS.manifest(), FRICTIONAL.manifest()
    both = pd.concat([smooth[["split", "licence"]], rubbed[["split", "licence"]]])
    splits = both["split"].value_counts()
    licences = ", ".join(f"{name} ({count})" for name, count in both["licence"].value_counts().items())
    return Template(HERE.joinpath("card.md").read_text(encoding="utf-8")).substitute(
        identity=identity(),
        version=VERSION,
        licence=LICENCE.lower(),
        licences=licences,
        smooth=len(smooth),
        rubbed=len(rubbed),
        smallest=smooth["unknowns"].min(),
        largest=smooth["unknowns"].max(),
        megabytes=f"{(smooth['bytes'].sum() + rubbed['bytes'].sum()) / 1e6:.0f}",
        tune=splits[TUNE],
        test=splits[TEST],
        arrays=len(kept_names()),
        kinds=", ".join(f"{count} {kind}" for kind, count in smooth["kind"].value_counts().items()),
    )


def altered(directory: Path) -> Iterator[str]:
    """Files that differ from their checksum, one line each, which begins with the name; none without CHECKSUMS."""
    path = directory / CHECKSUMS
    if not path.exists():
        return
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        match = LINE.fullmatch(line)
        if match is None:
            yield f"{CHECKSUMS}: {line[:80]!r} must be a SHA-256 and the name of a file"
        elif not (directory / match[2]).is_file():
            yield f"{match[2].removesuffix('.npz')}: missing"
        elif _digest(directory / match[2]) != match[1]:
            yield f"{match[2].removesuffix('.npz')}: not the file that {CHECKSUMS} names"


def _names() -> list[str]:
    return sorted([*STEPS.manifest()["name"], *FRICTIONAL.manifest()["name"]])


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
