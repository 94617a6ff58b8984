"""Twenty-one contradictions that earlier pages had: the rules behind them, held against the committed pages.

A rule goes from the texts of pages to what breaks it. ``contradictions.txt`` has with each rule an excerpt of the pages
that had the contradiction, in which the rule must find it. A rule that compares also breaks where it finds nothing to
compare.

By number, what is held here:

- 1: the error of a measure is told in the limit of the meshes, with its interval
- 2: one number of unknowns for one error of the tyre's force, and no grid that gets coarser with the error
- 3: one time and one mesh for one question
- 4: of the requests that fail are counted those whose path another algorithm follows to its load
- 5: no approximate strains where their own error is larger than the one that they are offered for
- 6: no empty range
- 7: the uncertainty of a limit is a share of it, the same on a sheet as in the table of limits
- 8: the limit in the sentence on the hemisphere is that of the default element in the table
- 9, 10: comparisons with references are counted once, of exact and of linear strains apart
- 11: a printed error is the value over the reference, less one
- 12: linear strains change the force of the tyre by one number
- 13: the mirror asymmetry in a conclusion is that of the paper's tyre
- 14: what ε changes is told with its mesh, and is one number a mesh; the error of a measure is one on page and sheet
- 15: the README knows no other limits of units and travel than the pages
- 16: short waves are named where errors of the tyre's force are listed
- 17: false claims are counted once, and their problems are named
- 18: no page has no mesh and a mesh
- 19: agreement by errors that cancel is listed
- form: no section is empty; one is not a plural

And elsewhere, of tables that are made up:

- 5, too: ``test_a_crossing_of_the_reference_is_no_accuracy``
- 20: ``test_beside_dissipation_stands_that_it_converges_with_the_load_step``
- 21: ``test_a_force_that_agrees_by_chance_is_excluded_with_its_numbers``
- what the paper's algorithm lacks: ``test_page_one_says_what_the_paper_s_algorithm_lacks``
"""

from __future__ import annotations

import gzip
import io
import math
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from functools import cache
from itertools import pairwise, takewhile
from pathlib import Path

import pandas as pd
import pytest

from formulations.strains.catalogue import MEASURES

Pages = Mapping[str, str]  # by name: text
Row = Mapping[str, str]  # of a table, by its heads

ROOT = Path(__file__).parents[2]
PAGES = ROOT / "reports" / "pages"
CELLS, README = "data/cells.csv.gz", "README.md"
NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?")
NOTHING = "nothing to compare"
APPROXIMATE = {*MEASURES} - {"exact"}
NOISE, ALIKE = 0.2, 1.5  # s, below which noise decides; times that are one, from run to run
SOLVED, REFUSED = ("converged", "unstable"), "unsupported"
PARTS = ("mesh", "shell", "law", "friction", "reading", "remainder")  # of a force that was measured
HEMISPHERE = ("hemisphere", "inward [mm]")
ERRORS = (("limit", "reference", "limit off"), ("here", "target", "error"), ("theirs", "ours", "off"))
LINEAR_WORDS = (
    r"linear strains change the force of the tyre by ([-+][\d.]+) % ± [\d.]+ % at a travel of 20 mm",
    r"20 mm of travel of the tyre .*`linear` \(([-+][\d.]+) %",
    r"Linear strains are ([-+][\d.]+) % off there",
)
CANCELS = 0.1  # what is left of parts that cancel, over the largest of them


@cache
def committed() -> Pages:
    """All but the pages of the quick campaign, with the README and the table of cells."""
    paths = [*sorted(PAGES.glob("*.md")), *sorted(PAGES.glob("sheets/*.md"))]
    texts = {path.relative_to(PAGES).as_posix(): path.read_text(encoding="utf-8") for path in paths}
    texts[README] = (ROOT / README).read_text(encoding="utf-8")
    texts[CELLS] = gzip.decompress((PAGES / CELLS).read_bytes()).decode("utf-8")
    return texts


# --- texts, tables, numbers -----------------------------------------------------------------------------------------


def written(pages: Pages) -> Iterator[tuple[str, str]]:
    """Names and texts of the pages alone."""
    yield from ((name, text) for name, text in pages.items() if name not in (README, CELLS))


def said(pages: Pages, pattern: str) -> Iterator[tuple[str, re.Match[str]]]:
    """Every place on the pages where the words of a pattern are."""
    yield from ((name, actual) for name, text in written(pages) for actual in re.finditer(pattern, text))


def tables(text: str) -> Iterator[tuple[str, list[dict[str, str]]]]:
    """Titles and rows; a head that comes again has its number behind it."""
    lines, title = text.splitlines(), ""
    for number, (line, below) in enumerate(pairwise([*lines, ""])):
        title = line.strip("*") if line.startswith("**") else title
        if below.startswith("| :--"):
            words = words_of(line)
            heads = [f"{w} {n + 1}" if (n := words[:i].count(w)) else w for i, w in enumerate(words)]
            rows = takewhile(lambda each: each.startswith("|"), lines[number + 2 :])
            yield title, [dict(zip(heads, words_of(each), strict=True)) for each in rows]


def words_of(line: str) -> list[str]:
    return [word.strip() for word in line[1:-1].split("|")]


def rows_with(pages: Pages, *heads: str) -> Iterator[tuple[str, str, Row]]:
    """Page, title and row of every table that has all of these heads."""
    for name, text in written(pages):
        yield from ((name, title, row) for title, rows in tables(text) for row in rows if row.keys() >= {*heads})


def bare(word: str) -> str:
    return word.replace("`", "")


def problem_of(row: Row) -> str:
    return bare(row.get("problem", row.get("scene", "")))


def measure_of(page: str) -> str:
    """That of a sheet, a name of no measure else."""
    return page.removeprefix("sheets/measure-").removesuffix(".md")


def first(words: str) -> float:
    """The first number of a cell, NaN where it has none."""
    actual = NUMBER.search(words)
    return float(actual[0]) if actual else math.nan


def half(words: str) -> float:
    """Half of the last digit of the first number."""
    number = NUMBER.search(words)
    if number is None:
        return math.nan
    digits, _, power = number[0].partition("e")
    return 0.5 * 10.0 ** (int(power or 0) - len(digits.partition(".")[2]))


def several(found: Mapping[object, set[object]]) -> Iterator[str]:
    """What has more than one answer, or that nothing was found at all."""
    if not found:
        yield NOTHING
    yield from (f"{key}: {sorted(map(str, own))}" for key, own in found.items() if len(own) > 1)


# --- the rules ------------------------------------------------------------------------------------------------------


def measures_on_one_mesh(pages: Pages) -> Iterator[str]:
    """1: a percentage of a measure without its interval, or words that it needs none."""
    for name, actual in said(pages, r".*(?:so the mesh is not in it|exact measure, on the same mesh).*"):
        yield f"{name}: {actual[0]}"
    for name, actual in said(pages, rf"`(?:{'|'.join(APPROXIMATE)})` \([-+][\d.]+ %\)"):
        yield f"{name}: {actual[0]}"
    for name, text in written(pages):
        for title, rows in tables(text):
            for row in rows:
                named = {measure_of(name), *row, *list(row.values())[:2]}
                messages = [word for word in row.values() if re.fullmatch(r"[-+][\d.]+ %", word)]
                if messages and {bare(word) for word in named} & APPROXIMATE:
                    yield f"{name}, {title}: {' | '.join(row.values())}"


def unknowns_of_an_error(pages: Pages) -> Iterator[str]:
    """2: unknowns for an error of the tyre's force, on uniform grids and the cheapest; a finer one takes no fewer."""
    actual = defaultdict[object, set[object]](set)
    for _, each in said(pages, r"within ([\d.]+) % (?:takes|on) a uniform (?:n x n )?grid of (\d+) unknowns"):
        actual[float(each[1])].add(int(each[2]))
    for _, each in said(pages, r"within ([\d.]+) % of its limit from (\d+) unknowns on with uniform grids"):
        actual[float(each[1])].add(int(each[2]))
    for _, each in said(pages, r"tyre, `force_N`: ([^`]*)"):
        for error, count in re.findall(r"([\d.]+) % costs [\d.]+ s and (\d+) unknowns", each[1]):
            actual[float(error)].add(int(count))
    for _, _, row in rows_with(pages, "error", "element", "grid", "unknowns"):
        if (bare(row["element"]), bare(row["grid"])) == ("refined", "uniform") and row["unknowns"].isdigit():
            actual[first(row["error"])].add(int(row["unknowns"]))
    yield from several(actual)
    sizes = defaultdict[tuple[str, ...], list[tuple[float, float]]](list)
    for name, _, row in rows_with(pages, "within", "seconds"):
        kind = (name, problem_of(row), row.get("measure", ""), row.get("element or part", ""))
        size = first(row["unknowns"]) if "unknowns" in row else elements(row["mesh"])
        sizes[kind].append((-first(row["within"]), size))
    for kind, own in sizes.items():
        if any(fine < coarse for (_, coarse), (_, fine) in pairwise(sorted(own))):
            yield f"{', '.join(filter(None, kind))}: {sorted(own)}"


def elements(mesh: str) -> float:
    return math.prod(map(int, mesh.split("x"))) if "x" in mesh else math.nan


def answers_of_a_question(pages: Pages) -> Iterator[str]:
    """3: times that two pages give for one error, and meshes that they give for one error and measure."""
    times, meshes = defaultdict[object, dict[str, float]](dict), defaultdict[object, set[object]](set)
    for name, _, row in rows_with(pages, "within"):
        problem = problem_of(row)
        if "seconds" in row and not math.isnan(first(row["seconds"])):
            times[problem, first(row["within"])][name] = first(row["seconds"])
        if row.get("element or part", "default") == "default" and "x" in row.get("mesh", ""):
            meshes[problem, first(row["within"]), bare(row.get("measure", measure_of(name)))].add(row["mesh"])
    for name, _, row in rows_with(pages, "scene", "quantity", "5 %", "1 %"):
        for error in ("5 %", "1 %"):
            if not math.isnan(first(row[error])):
                times[bare(row["scene"]), first(error)][name] = first(row[error])
    if not times:
        yield NOTHING
    for question, own in times.items():
        if max(own.values()) > max(NOISE, ALIKE * min(own.values())):
            yield f"{question}: {own} s"
    yield from several(meshes) if meshes else ()


def failures_told(pages: Pages) -> Iterator[str]:
    """4: what fails among the cells of problems put to two algorithms; and words that no cell bears out."""
    for actual in re.finditer(r"end on the same contact set and force", pages.get(README, "")):
        yield f"{README}: {actual[0]}"
    table = pd.read_csv(io.StringIO(pages[CELLS])).dropna(subset=["command"])
    table["problem"] = table["command"].str.replace(r" --contact \S+", "", regex=True)
    table = table[table.groupby("problem")["contact"].transform("nunique") > 1]
    solved = table["outcome"].isin(SOLVED)
    passed = solved.groupby(table["problem"]).transform("any")
    lost = int((~solved & (table["outcome"] != REFUSED) & (table["path_end"].isna() | passed)).sum())
    names = {(name, int(actual[1])) for name, actual in said(pages, r"put to \d+ (?:contact )?algorithms (\d+) fail")}
    yield from (f"{name}: {count} fail, but {lost} do" for name, count in sorted(names) if count != lost)
    if not names:
        yield NOTHING


def better_than_their_formulation(pages: Pages) -> Iterator[str]:
    """5: meshes of approximate strains with an error below that of the measure in the limit, or without a limit."""
    limits = dict[tuple[str, str], str]()
    for name, text in written(pages):
        for title, rows in tables(text):
            for row in rows:
                head, *rest = row
                if head == "problem" and name == "index.md":
                    limits |= {(bare(row[head]), bare(each)): row[each] for each in rest if bare(each) in MEASURES}
                elif head == "measure" and rest[0].startswith("error at"):
                    limits[title.partition(":")[0], bare(row[head])] = row[rest[0]]
    if not limits:
        yield NOTHING
    for name, _, row in rows_with(pages, "measure", "mesh"):
        problem, measure = problem_of(row), bare(row["measure"])
        error = first(row.get("error at most", row.get("error", "")))
        if measure != "exact" and not math.isnan(error):
            limit = limits.get((problem, measure), "")
            if math.isnan(first(limit)) or (not limit.startswith("below") and abs(first(limit)) > error):
                yield f"{name}: {measure} within {error:g} % on {problem} {row['mesh']}, in the limit {limit or '?'}"


def empty_ranges(pages: Pages) -> Iterator[str]:
    """6: from a number to below a smaller one."""
    for name, actual in said(pages, rf"from ({NUMBER.pattern})(?: on)? to below ({NUMBER.pattern})"):
        if float(actual[1]) >= float(actual[2]):
            yield f"{name}: {actual[0]}"


def limits_in_words(pages: Pages) -> Iterator[str]:
    """8: the limit of the hemisphere in words and in the table, and its distance from the published value."""
    text = pages["convergence.md"]
    rows = [row for _, own in tables(text) for row in own if (row.get("scene"), row.get("quantity")) == HEMISPHERE]
    limits = [row.get("limit", row.get("extrapolated", "")) for row in rows]
    words = r"hemisphere converges to ([\d.]+) mm, ([-+][\d.]+) % from the published ([\d.]+)"
    lines = re.findall(words, text)
    if not limits or not lines:
        yield NOTHING
    for limit, off, published in lines:
        if any(abs(float(limit) - first(each)) > half(limit) + half(each) for each in limits):
            yield f"{limit} mm in words, {limits} in the table"
        if abs(100 * (float(limit) / float(published) - 1) - float(off)) > half(off) + 100 * half(limit):
            yield f"{off} % is not {limit} over {published}"


def comparisons_counted(pages: Pages) -> Iterator[str]:
    """9, 10: how many limits agree with references: a number for each kind of strains, and none for both."""
    actual = defaultdict[object, set[object]](set)
    words = r"(?:With (\w+) strains |[Ii]n )(\d+) of (\d+) comparisons"
    for name, each in said(pages, words):
        if each[1] is None:
            yield f"{name}: {each[0]}, of any strains"
        actual[each[1]].add((int(each[2]), int(each[3])))
    for name, _, row in rows_with(pages, "scenes of", "comparisons", "agree"):
        strains = re.fullmatch(r"(\w+) strains", row["scenes of"])
        if strains and name == "convergence.md":
            actual[strains[1]].add((int(row["agree"]), int(row["comparisons"])))
    yield from several(actual)


def wrong_errors(pages: Pages) -> Iterator[str]:
    """11: errors that are not the value over the reference, less one, as far as all three are rounded."""
    count = 0
    for value, reference, error in ERRORS:
        for name, title, row in rows_with(pages, value, reference, error):
            x, y, stated = (first(row[head]) for head in (value, reference, error))
            if any(map(math.isnan, (x, y, stated))) or y == 0:
                continue
            count += 1
            rounded = half(row[error]) + 100 * (half(row[value]) + abs(x / y) * half(row[reference])) / abs(y)
            if abs(100 * (x / y - 1) - stated) > 1.01 * rounded:
                yield f"{name}, {title}: {x:g} over {y:g} is no {row[error]}"
    if not count:
        yield NOTHING


def forces_of_linear_strains(pages: Pages) -> Iterator[str]:
    """12: the force of the tyre at 20 mm by linear strains over that by exact ones, in words and in tables."""
    actual = dict[str, float]()
    for words in LINEAR_WORDS:
        actual |= {f"{name}: {each[0]}": 1 + float(each[1]) / 100 for name, each in said(pages, words)}
    for name, each in said(pages, r"([\d.]+) (?:± [\d.]+ )?times (?:the force of exact strains|as much, where)"):
        actual[f"{name}: {each[0]}"] = float(each[1])
    for name, title, row in rows_with(pages, "problem", "`linear`"):
        if bare(row["problem"]) == "tyre at delta_mm=20: force_N":
            actual[f"{name}, {title}"] = 1 + first(row["`linear`"]) / 100
    for name, title, row in rows_with(pages, "changed", "at 20 mm"):
        if row["changed"] == "`linear`":
            actual[f"{name}, {title}"] = 1 + first(row["at 20 mm"]) / 100
    if not actual:
        yield NOTHING
    elif max(actual.values()) - min(actual.values()) > 0.006:  # the last digit of a factor
        yield str(actual)


def mirrors(pages: Pages) -> Iterator[str]:
    """13: the mirror asymmetry in MPa and in per cent of the peak, in a conclusion and on the page of the tyre."""
    words = r"mirror symmetry of (?:its|the) contact pressure by (?:up to )?([\d.]+) MPa, ([\d.]+) %"
    actual = defaultdict[object, set[object]](set)
    for _, each in said(pages, words):
        actual["of the paper's tyre"].add(each.groups())
    if not actual:
        yield NOTHING
    for each in re.finditer(r"by up to ([\d.]+) MPa(?:,| or) ([\d.]+) % of (?:its|the) peak", pages["tyre.md"]):
        actual["of the paper's tyre"].add(each.groups())
    yield from several(actual)


def effects_of_epsilon(pages: Pages) -> Iterator[str]:
    """14: what a finite ε changes in the force at 20 mm, to one digit, by the mesh that is named beside it."""
    actual = defaultdict[object, set[object]](set)
    for name, text in written(pages):
        for sentence in re.split(r"(?<=[.;:|]) |\n", text):
            each = re.search(r"force .*20 mm .*?(\d\.?\d*e-\d+)", sentence)
            if each and (mesh := re.search(r"\d+x\d+", sentence)):
                actual[mesh[0]].add(f"{float(each[1]):.0e}")
            elif each:
                yield f"{name}: {sentence}"
    yield from several(actual)


def limits_of_the_readme(pages: Pages) -> Iterator[str]:
    """15: units that may matter where no problem shows it, and a travel that no limit on the pages is at."""
    text = " ".join(pages[README].split())
    changed = {
        int(each[1]) for _, each in said(pages, r"million times larger or smaller, (\d+) of \d+ contact problems")
    }
    if re.search(r"million times larger or smaller it may refuse", text) and changed == {0}:
        yield "units that may matter"
    rows = [each[0] for _, each in said(pages, r"\| smallest travel, travel over thickness.*")]
    known = {float(number) for row in rows for number in re.findall(r"1e-\d+", row.split("|", 2)[2])}
    names = {float(number) for number in re.findall(r"travels? below (\d+e-\d+)", text)}
    if not known or not names or not changed:
        yield NOTHING
    yield from (f"a travel of {number:g}" for number in sorted(names - known))


def waves_unnamed(pages: Pages) -> Iterator[str]:
    """16: sections of the page of the tyre that say how well its force is known, and not what is beside the patch."""
    sections = re.split(r"^## ", pages["tyre.md"], flags=re.MULTILINE)
    own = [each for each in sections if re.search(r"limit of (?:its )?grids\b.*%", each)]
    if not own:
        yield NOTHING
    yield from (each.partition("\n")[0] for each in own if "short waves" not in each.lower())


def false_claims(pages: Pages) -> Iterator[str]:
    """17: how many claims are false, without the problems that they are on, or with two counts of one number."""
    actual = defaultdict[object, set[object]](set)
    for name, text in written(pages):
        for line in text.splitlines():
            for claims, count in re.findall(r"(\d+) (?:answers of the algorithms|claims,)[^.]*?(\d+) are false", line):
                actual[claims].add(count)
                if not re.search(r"\bsmall\b", line):
                    yield f"{name}: {line}"
    ours = [row for _, _, row in rows_with(pages, "solver", "false") if row["solver"] == "semismooth"]
    counts = [first(row[head]) for row in ours for head in row if head.startswith("false")]
    if any(count > 0 for count in counts) and not any(said(pages, r"claims of `semismooth`")):
        yield f"false claims of semismooth, {counts}, in a table only"
    yield from several(actual)


def no_mesh_and_a_mesh(pages: Pages) -> Iterator[str]:
    """18: pages that say to have none."""
    for name, actual in said(pages, r"no mesh[^.]*on this page"):
        if re.search(r"\b\d+x\d+\b|\b\d+ by \d+ elements", pages[name]):
            yield f"{name}: {actual[0]}"


def unlisted_cancellations(pages: Pages) -> Iterator[str]:
    """19: forces near the measured one, whose parts of both signs are ten times what is left, in no list of these."""
    count = 0
    for name, _, row in rows_with(pages, "body", "computed - measured", *PARTS):
        count += 1
        parts, left = [first(row[part]) for part in PARTS], abs(first(row["computed - measured"]))
        if left <= CANCELS * min(max(parts), -min(parts)) and f"\n- {row['body']} at " not in pages[name]:
            yield f"{name}: {row['body']}, {left:g} N of {parts}"
    if not count:
        yield NOTHING


def uncertainties(pages: Pages) -> Iterator[str]:
    """7: more than 100 %, and on a sheet another one than the table of limits has of the same limit."""
    limits = defaultdict[object, set[str]](set)
    for _, _, row in rows_with(pages, "limit", "finest mesh", "±"):
        limits[row["finest mesh"], row["limit"]].add(row["±"])  # of two ladders with one limit both
    sheets = list(rows_with(pages, "limit of finer meshes", "finest mesh", "±"))
    if not sheets:
        yield NOTHING
    for name, _, row in sheets:
        here, there = row["±"], limits[row["finest mesh"], row["limit of finer meshes"]]
        alike = [each for each in there if abs(first(here) - first(each)) <= half(here) + half(each)]
        if first(here) > 100 or (there and not alike):
            yield f"{name}: ± {here}, and {there or 'nothing'} in the table of limits"


def formulations_on_sheets(pages: Pages) -> Iterator[str]:
    """14: the error of a measure in the limit of the meshes, on its sheet and on page one."""
    actual = defaultdict[object, set[object]](set)
    for name, _, row in rows_with(pages, "problem", "in the limit of the meshes"):
        if measure_of(name) != "exact":
            actual[problem_of(row), measure_of(name)].add(row["in the limit of the meshes"].removesuffix(" †"))
    for _, _, row in rows_with(pages, "problem", "`linear`", "`donnell`"):
        for head, word in row.items():
            if bare(head) in MEASURES:
                actual[problem_of(row), bare(head)].add(word.removesuffix(" †"))
    yield from several(actual)


def waves_unnamed_beside_the_force(pages: Pages) -> Iterator[str]:
    """16: as ``waves_unnamed``, of the sentence on the force."""
    for name, each in said(pages, r"force of the paper's tyre at 20 mm is [\d.]+ N in the limit of its grids.*"):
        if "short waves" not in each[0]:
            yield f"{name}: {each[0][:90]}"


def one_of_many(pages: Pages) -> Iterator[str]:
    """1 comparisons, 1 times."""
    for name, each in said(pages, r"(?<![\w.,/^+=-])1 (?!iterations, )[a-z]{3,}s\b[^.,;]*"):
        if not re.match(r"1 (diverges|needs|has|is|was)\b", each[0]):
            yield f"{name}: {each[0]}"


def empty_sections(pages: Pages) -> Iterator[str]:
    """Headings without a text below, or with words in its place."""
    for name, text in written(pages):
        prose = re.sub(r"```.*?```", "code", text, flags=re.DOTALL)
        lines = [line for line in prose.splitlines() if line.strip() and not line.startswith("<!--")]
        for line, below in pairwise([*lines, "# the end"]):
            depth, beneath = (len(each) - len(each.lstrip("#")) for each in (line, below))
            if depth and (0 < beneath <= depth or below.startswith("Not measured")):
                yield f"{name}: {line}"


# --- what earlier pages said ----------------------------------------------------------------------------------------


def earlier() -> Iterator[tuple[str, dict[str, str]]]:
    """A rule by its name, with the pages in which it must find its contradiction."""
    _, *blocks = re.split(r"\n\n%% (\w+)\n", (Path(__file__).parent / "contradictions.txt").read_text(encoding="utf-8"))
    for rule, block in zip(blocks[::2], blocks[1::2], strict=True):
        _, *pages = re.split(r"^%% (.*)\n", block, flags=re.MULTILINE)
        yield rule, dict(zip(pages[::2], pages[1::2], strict=True))


EARLIER = list(earlier())
RULES = sorted({rule for rule, _ in EARLIER})


@pytest.mark.parametrize("rule", RULES)
def test_committed_pages_do_not_contradict_themselves(rule: str) -> None:
    assert list(globals()[rule](committed())) == []


@pytest.mark.parametrize("number", range(len(EARLIER)))
def test_what_earlier_pages_said_is_seen(number: int) -> None:
    rule, pages = EARLIER[number]
    assert [each for each in globals()[rule](pages) if each != NOTHING] != []
