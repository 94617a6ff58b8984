"""All floating-point operations of a piece of work, by kind: those of the elements, and those of contact."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from contact import operations as of_contact
from formulations import operations as of_elements

KINDS = (of_elements.ASSEMBLY, *of_contact.KINDS)


@contextmanager
def counted() -> Iterator[dict[str, int]]:
    """Operations of what is done inside, by kind; filled in when it has ended, however it ends."""
    before, work = _done(), dict[str, int]()
    try:
        yield work
    finally:
        work.update({kind: done - before[kind] for kind, done in _done().items()})


def _done() -> dict[str, int]:
    return {**of_elements.SPENT, **of_contact.SPENT}
