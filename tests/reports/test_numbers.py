"""What the pages do with numbers: comparisons of pages, and formats."""

from __future__ import annotations

import pytest

from reports.compare import differences, same_number
from reports.formats import digits, fixed, percent, scientific, share
from reports.markdown import machine, prose


@pytest.mark.parametrize(
    ("a", "b", "same"),
    [
        ("12.34", "12.35", True),
        ("12.34", "12.36", False),
        ("211", "212", False),
        ("211", "211", True),
        ("1959.049892", "1959.049999", True),
        ("1959.049892", "1959.149892", False),
        ("3.0e-13", "7.1e-09", True),
        ("0", "7.1e-09", True),
        ("0", "0.3", False),
        ("3.0e-13", "2.0e-08", False),
        ("-8.02e-07", "-8.03e-07", True),
        ("-8.02e-07", "+8.02e-07", False),
    ],
)
def test_numbers_agree_to_their_last_digit(a: str, b: str, same: bool) -> None:
    assert same_number(a, b) is same


def test_inserted_and_lost_lines_are_differences_of_their_own() -> None:
    assert len(differences("p.md", "a 1\nb 2\n", "a 1\nnew\nb 2\n")) == 1
    assert differences("p.md", "a 1\nb 2\n", "b 2\n") == ["p.md:1: committed 'a 1', regenerated ''"]
    assert differences("p.md", f"x\n{machine('9 s')}\ny 1", f"x\n{machine('8 s')}\n\ny 1") != []
    assert differences("p.md", f"x\n{machine('9 s')}", "x") != []


def test_zero_has_no_sign_in_any_format() -> None:
    assert fixed(-0.0004, 2) == "0.00"
    assert fixed(-0.0004, 2, sign=True) == "0.00"
    assert percent(-1e-9) == "0.00 %"
    assert (percent(-0.0123), percent(0.0123), share(-0.0123)) == ("-1.23 %", "+1.23 %", "-1.23 %")
    assert digits(-0.0, 3) == "0.00"
    assert scientific(-0.0) == "0"
    assert fixed(None, 2) == scientific(None) == percent(None) == "–"


def test_prose_joins_lines_but_not_items() -> None:
    assert prose("a\nb\n\n- c\n  d\n- e") == "a b\n\n- c d\n- e"
