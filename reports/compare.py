"""Are two versions of a page the same, but for the machine they were made on?

Words must be equal; numbers equal to within one unit of their last printed digit, or RELATIVE; whole numbers exactly;
numbers that are both below ROUNDING count as equal, for they are residuals. Machine blocks are skipped.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from difflib import SequenceMatcher
from itertools import zip_longest

from reports.markdown import END_MACHINE, MACHINE

RELATIVE = 1e-5  # other BLAS kernels move converged results by 1e-11; a change of method moves them by more than this
ROUNDING = 1e-8
NUMBER = re.compile(r"(?<![A-Za-z_\d.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")

Line = tuple[int, str]  # number in the file, text


def differences(page: str, committed: str, regenerated: str) -> list[str]:
    """One line per difference: page, line of the committed page, what it says, what it would say now."""
    old, new = list(_compared(committed)), list(_compared(regenerated))
    matcher = SequenceMatcher(None, [_words(text) for _, text in old], [_words(text) for _, text in new], False)
    lines = []
    for kind, a0, a1, b0, b1 in matcher.get_opcodes():
        pairs = list(zip_longest(old[a0:a1], new[b0:b1], fillvalue=(0, "")))  # no partner: beside an empty line
        if kind == "equal":
            pairs = [(a, b) for a, b in pairs if not _same_numbers(a[1], b[1])]
        at = old[min(a0, len(old) - 1)][0] if old else 1
        lines += [f"{page}:{a[0] or at}: committed {a[1]!r}, regenerated {b[1]!r}" for a, b in pairs]
    return lines


def of_the_machine(text: str, names: Iterable[str]) -> set[str]:
    """The names that are in machine blocks of a text and nowhere else in it."""
    steady = "\n".join(line for _, line in _compared(text))
    return {name for name in names if name in text and name not in steady}


def _compared(text: str) -> Iterator[Line]:
    """The lines outside machine blocks, with their numbers in the file."""
    skipping = False
    for number, line in enumerate(text.splitlines(), start=1):
        skipping = skipping and line != END_MACHINE
        if not skipping:
            yield number, line
        skipping = skipping or line == MACHINE


def _words(line: str) -> str:
    return NUMBER.sub("#", line)


def _same_numbers(a: str, b: str) -> bool:
    return all(same_number(x, y) for x, y in zip(NUMBER.findall(a), NUMBER.findall(b), strict=True))


def same_number(a: str, b: str) -> bool:
    """Do two printed numbers agree?"""
    x, y = float(a), float(b)
    if a == b or (_is_whole(a) and _is_whole(b)):
        return x == y
    if abs(x) < ROUNDING and abs(y) < ROUNDING:
        return True
    allowed = max(_last_digit(a), _last_digit(b), RELATIVE * max(abs(x), abs(y)))
    return abs(x - y) <= allowed * (1 + 1e-9)  # the subtraction itself rounds


def _is_whole(text: str) -> bool:
    return text.lstrip("+-").isdigit()


def _last_digit(text: str) -> float:
    """One unit of the last printed digit; nothing for a whole number."""
    if _is_whole(text):
        return 0.0
    mantissa, _, exponent = text.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    return float(10.0 ** (int(exponent or 0) - decimals))
