"""Which problems of the collection are for tuning, and which are ranked by.

A scene with its settings, or a published source, is in one of the two with all its meshes, loads, iterates and derived
forms: what is tuned on one says nothing of the other by being nearly the same matrix.
"""

from __future__ import annotations

import hashlib
import re

TUNE, TEST = "tune", "test"
SALT = 2  # the first by which each kind of matrix is in both
FIFTH = 5  # one source of so many is for tuning
FORM = re.compile(r"-(touching|condensed)$")
ITERATE = re.compile(r"-s\d+(i\d+)?$")
MESH = re.compile(r"-\d+x\d+(?=-|$)")
POINTS = re.compile(r"-\d+$")  # of a published problem


def split_of(name: str) -> str:
    """TUNE or TEST, by a hash of what the problem ``name`` is of."""
    source = name
    for each in (FORM, ITERATE, MESH, POINTS):
        source = each.sub("", source)
    return TUNE if int(hashlib.sha256(f"{SALT} {source}".encode()).hexdigest(), 16) % FIFTH == 0 else TEST
