"""The pages of a store: rendered as a whole, then written, or compared with the ones that are committed.

Each page is a function of the store; no page is written before all are rendered. Beside them, all pages in one HTML,
which is neither committed nor compared. Two versions of a page are the same but for the machine they were made on when
words are equal; numbers equal to within one unit of their last printed digit, or RELATIVE; whole numbers exactly;
numbers that are both below ROUNDING count as equal, for they are residuals. Machine blocks are skipped.
"""

from __future__ import annotations

import re
import sys
import traceback
from collections.abc import Collection, Iterable, Iterator, Mapping
from difflib import SequenceMatcher
from itertools import zip_longest
from pathlib import Path

from reports.chapter import ALL, INDEX, INDEX_TITLE, Chapter, conclusions, grouped, link_line, listed, of_page, relative
from reports.chapters.gallery import sheets, with_appearances
from reports.chapters.index import DATA, campaign_page, data_files, index_page
from reports.contents import CHAPTERS, OURS
from reports.files import StoreError, write_texts
from reports.html import REPORT, report_html
from reports.markdown import END_MACHINE, MACHINE, Part, joined
from reports.origin import completeness_line, foot
from reports.store import Store, load_store

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


FIGURES = "figures"
UNDRAWN = "<svg/>\n"
LINK = re.compile(r"\[([^\[\]]+)\]\(([\w./-]+\.md)(?:#[^)]*)?\)")


def write_pages(store: Path, out: Path, campaign: str | None = None) -> list[Path]:
    """Render everything, then write it into ``out``; returns the paths. After a StoreError nothing is written."""
    return write_texts(out, files_of(store, campaign))


def check_pages(store: Path, out: Path, campaign: str | None = None) -> list[str]:
    """Differences between the pages in ``out`` and those of the store, a line each; pictures need only be there."""
    return compare_pages(files_of(store, campaign, draw=False), out)


def place_of(store: Path, campaign: str | None = None) -> tuple[str, str]:
    """The folder below the pages that those of a campaign belong to, and how complete it is in one line."""
    loaded = load_store(store, campaign)
    return "" if loaded.pages == ALL else loaded.campaign, completeness_line(loaded)


def files_of(path: Path, campaign: str | None = None, *, draw: bool = True) -> dict[str, str]:
    """As rendered; raises StoreError for what no page can show, and names that lead out, as tables of others have."""
    store = load_store(path, campaign)
    try:
        files = rendered(store, draw=draw)
    except StoreError:
        raise
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        said = " ".join(f"{_place(error)}{type(error).__name__}: {error}".split())[:300]
        raise StoreError(f"{store.path}: campaign {store.campaign!r} cannot be put on pages: {said}") from error
    for name in files:
        if name.startswith("/") or ".." in name.split("/"):
            raise StoreError(f"{store.path}: the page {name!r} leads out of its folder")
    return files


def _place(error: BaseException) -> str:
    """The line of a page from outside that it was raised in, or that called what raised it; else nothing."""
    sources = {getattr(sys.modules.get(each.render.__module__), "__file__", "") for each in CHAPTERS if _outside(each)}
    frames = reversed(traceback.extract_tb(error.__traceback__))
    return next((f"{Path(at.filename).name}:{at.lineno}: " for at in frames if at.filename in sources), "")


def _outside(chapter: Chapter) -> bool:
    return chapter.file not in OURS


def left_out(path: Path, campaign: str | None = None) -> list[str]:
    """A line for each page from outside that the store has not all tables for; raises StoreError."""
    store = load_store(path, campaign)
    missing = {each.file: [name for name in each.needs if not store.has(name)] for each in CHAPTERS if _outside(each)}
    return [f"{file} is left out: {path} has no table {', '.join(names)}" for file, names in missing.items() if names]


def rendered(store: Store, *, draw: bool = True) -> dict[str, str]:
    """All files by name: pictures first, so that a page never links to one that is not there yet.

    draw: False where only the names of the pictures count; none is drawn then.
    """
    chapters = [each for each in CHAPTERS if each.applies(store)] + sheets(store)
    first = index_page if store.pages == ALL else campaign_page
    made = {each.file: _made(each, store) for each in chapters}
    absent = {each.file for each in CHAPTERS} - {each.file for each in chapters}
    made = {INDEX: joined(first(store, listed(chapters))), **made}
    parts = {name: Part(without_links(part.text, absent), part.pictures) for name, part in made.items()}
    pictures = {name: each() if draw else UNDRAWN for part in parts.values() for name, each in part.pictures.items()}
    texts = with_appearances({name: part.text for name, part in parts.items()}, chapters)
    titles = {INDEX: INDEX_TITLE, **{each.file: each.title for each in chapters}}
    answers = {each.file: of_page(store, each.name) for each in chapters}
    texts_headed = {name: _headed(text, answers.get(name, "")) for name, text in texts.items()}
    linked = {name: _headed(texts[name], answer, link_line(chapters, name)) for name, answer in answers.items()}
    svgs = {f"{FIGURES}/{name}": svg for name, svg in pictures.items()}
    groups = {group: [each.file for each in pages] for group, pages in grouped(chapters).items()}
    footed = {name: f"{text}\n{foot(store)}\n" for name, text in {**texts, **linked}.items()}
    data = data_files(store) if any(each.name == DATA for each in chapters) else {}
    above = {each.file: f"{each.under}.md" for each in chapters if each.under}
    html = report_html(texts_headed, titles, pictures, groups, f"{foot(store)}\n\n{_terms(data)}", above)
    return {**svgs, **data, **footed, REPORT: html}


def _terms(data: Mapping[str, str]) -> str:
    """Licence and citation, below the pages in one file."""
    where = f": see [licence and citation]({DATA}.md#licence-and-citation)" if data else ""
    return f"© The Footprint authors; MIT licence. To be cited with version and commit{where}."


def _made(chapter: Chapter, store: Store) -> Part:
    """A page; raises StoreError for a column that its tables lack, as those of another version may."""
    try:
        part = chapter.render(store)
    except KeyError as error:
        tables = ", ".join(chapter.needs) or "its cells"
        raise StoreError(f"{store.path}: {chapter.file} lacks {error}, of {tables}") from error
    text = part.text.replace(f"]({FIGURES}/", f"]({relative(FIGURES, chapter.file)}/")
    return joined(text, conclusions(store, chapter.name), Part(pictures=part.pictures))


def without_links(text: str, absent: Collection[str]) -> str:
    """A text in which links to pages that this campaign does not have are words only."""

    def kept(match: re.Match[str]) -> str:
        return match[1] if match[2] in absent else match[0]

    return LINK.sub(kept, text)


def _headed(text: str, *lines: str) -> str:
    """A page with lines under its heading: its answer, and the links to others."""
    heading, _, rest = text.partition("\n\n")
    return "\n\n".join(filter(None, [heading, *lines, rest]))


def compare_pages(files: Mapping[str, str], out: Path) -> list[str]:
    """Differences between ``files`` and what is in ``out``; of the one HTML and of the data nothing is asked.

    Pictures in machine blocks alone may come and go with what was measured.
    """
    files = {name: text for name, text in files.items() if name.endswith((".md", ".svg"))}
    folders = {out, *((out / name).parent for name in files if name.endswith(".md"))}
    pages = [path for folder in sorted(folders) for path in folder.glob("*.md")]
    there = {path.relative_to(out).as_posix() for path in [*pages, *(out / FIGURES).glob("*.svg")]}
    texts = [text for name, text in files.items() if name.endswith(".md")]
    texts += [(out / name).read_text(encoding="utf-8") for name in there if name.endswith(".md")]
    pictures = {name for name in there | set(files) if name.endswith(".svg")}
    measured = of_the_machine("\n".join(texts), pictures)
    faults = [f"{name}: missing in {out}" for name in files if name not in there | measured]
    faults += [f"{name}: in {out}, but no longer made" for name in sorted(there - set(files) - measured)]
    common = [name for name in files if name.endswith(".md") and name in there]
    if not common:
        faults.append(f"{out}: no page to compare")
    for name in common:
        faults += differences(name, (out / name).read_text(encoding="utf-8"), files[name])
    return faults
