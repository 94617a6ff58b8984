"""How contact algorithms behave far from the solution: large steps, the end of the path, cycles, false claims."""

from __future__ import annotations

from reports.chapters.contact.agreement_cases import unusual
from reports.chapters.contact.known_answers import known_answers
from reports.chapters.tyre.cells import DELTA, FAR, ONE_STEP
from reports.formats import fixed, scientific
from reports.markdown import Part, commands, filled, joined, listing, machine, prose, table
from reports.store.cells import Cell
from reports.store.tables import Store

SETTLE, MESHES = (0.05, 1.0), ("28x26", "42x40", "84x80")  # the algorithm's own, and the textbook's
EXACT = 1e-9  # an error below it is no error


def robustness(store: Store) -> Part:
    """All of it, for the page of algorithms."""
    return joined(_one_step(store), _far(store), _cycles(store), _claims(store), *known_answers(store))


def _one_step(store: Store) -> Part:
    """Inflation, then 20 mm at once, on finer and finer meshes."""
    ways: dict[str, list[Cell]] = {}
    for settle in SETTLE:
        cells = [store.find(**ONE_STEP, settle=settle, mesh=mesh) for mesh in MESHES]
        usual = next(iter(ways.values()), cells)
        ways[", ".join([f"`{cells[0].result['contact']}`", *unusual(cells[0], usual[0])])] = cells
    rows = [[way, cell.result["mesh"], *_press(cell)] for way, cells in ways.items() for cell in cells]
    found = "; ".join(f"{way} {_growth(cells)}" for way, cells in ways.items())
    text = prose(f"""## Far from the solution

From the inflated tyre {DELTA:g} mm in one step. An algorithm that gives every set a linearisation of its own
(`settle` 1, the textbook's) changes between sets far from the solution; settled on one linearisation first, they cost
factorisations, but few iterations. From the second mesh to the last the iterations grow: {found}.""")
    header = ["algorithm", "mesh", "outcome", "iterations", "factorisations", "set changes", "steps cut"]
    told = commands(cell.command for cells in ways.values() for cell in cells)
    return joined(text, table("One step of 20 mm", header, rows, words=3), told)


def _press(cell: Cell) -> list[str]:
    step = cell.steps[-1] if cell.steps else {}
    counts = [fixed(step.get(name)) for name in ("newton_iterations", "factorisations", "set_changes")]
    return [str(cell.result["outcome"]), *counts, str(len(cell.cuts))]


def _growth(cells: list[Cell]) -> str:
    before, after = cells[-2:]
    if not (before.converged and after.converged) or before.cuts or after.cuts:
        return "diverges, and its step has to be cut"
    pair = [cell.steps[-1]["newton_iterations"] for cell in (before, after)]
    return f"from {pair[0]} to {pair[1]}"


def _far(store: Store) -> Part:
    """As far as the path goes, and why it ends."""
    cell = store.find(**FAR)
    heads = "travel [mm] | force [N] | contact nodes | iterations | sub-steps"
    line = "{delta_mm:g} | {force_N:.1f} | {contact_nodes:.0f} | {newton_iterations:.0f} | {substeps:.0f}"
    end = "The path reached all that was asked." if cell.converged else f"The end: {cell.result['reason']}."
    title = f"`{cell.result['contact']}` on {cell.result['mesh']}, as far as it goes"
    return joined(listing(title, cell.steps, heads, line), machine(end), commands([cell.command]))


def _cycles(store: Store) -> Part:
    """Sets that repeat themselves."""
    found = store.table("cycles")
    ways = list(found.columns[2:])
    text = prose("""## Cycles

The textbook's active set swaps all violators at once, with both bounds of an unknown as one set; on published problems
it comes back to a set it has had. No rule that swaps all violators can be shown to end: the smallest counterexample
has three unknowns and a symmetric positive definite matrix (3x3; Curtis, Han and Robinson, 2015). Here every bound is a
candidate of its own, which alone settles the two-sided ones. Where a set comes back, that is reported and the algorithm
solves
the linearised problem on the misplaced candidates by principal pivots: finite for every P-matrix (Cottle, Pang and
Stone, 1992), that is wherever the tangent is definite on the motions that contact leaves free, and contact lumped. An
indefinite tangent has no such theorem, and the linearised problem perhaps no solution.""")
    rows = [
        [line["problem"], _period(line["plain_period"]), *(line[way] for way in ways)]
        for line in found.to_dict("records")
    ]
    header = ["problem", "textbook", *map(_quoted, ways)]
    return joined(text, table("From the set that the textbook begins with", header, rows, words=len(header)))


def _period(period: int) -> str:
    return f"cycles, period {period}" if period else "settles"


def _claims(store: Store) -> Part:
    """Who says that it has solved a problem, and has not."""
    found = store.table("false_success")
    names = ("version", "worst", "worst_fails")
    found = found.assign(**{name: found[name].astype(object).where(found[name].notna(), "") for name in names})
    versions = ", ".join(sorted(set(found["version"]) - {""}))
    ours = found[~found["contender"].str.contains("alone")]
    alone = found[found["contender"].str.contains("alone")]
    heads = "solver | asked for | judge's bound | claims | false by its own | false by ours | largest error | where"
    line = "{contender} | {tolerance:.0e} | {bound:.0e} | {claimed} of {problems} | {false_own} | {false} | "
    line += "{largest_error:error} | {worst}"
    told = "; ".join(filled("{contender}: {false} of {claimed}, {false_own} by its own tolerance", alone))
    lost = alone[(alone["false_own"] > 0) & (alone["false"] > 0)].sort_values("tolerance", kind="stable")
    case = "; ".join(filled("{contender} on {worst}, off by {largest_error:.0%}, wrong in {worst_fails}", lost))
    text = prose(f"""## Who says that it has solved it

Every algorithm and setting, and the solvers of quadratic programmes alone and at their word (*alone*), over published
obstacle problems, classics of linear complementarity and linearised steps of shells in contact. Each answer that is
called solved is judged twice: by the tolerance that the solver was asked for, in its own criterion (for OSQP the
residuals of the programme it was given, over one and their terms), and by the judge of contact, whose bound is the same
for all. *Largest error*: of a displacement so called, over the largest displacement. Of our own
{int(ours["claimed"].sum())} claims {int(ours["false"].sum())} are false. False by ours: {told or "none"}. Not even what
was asked for is kept by: {case or "none"}. A finite ε is judged by its own law and differs from the exact answer by
that. Versions: {versions}.""")
    return joined(text, listing("Claims of success, judged twice", found, heads, line, error=_error))


def _error(error: float) -> str:
    return f"under {scientific(EXACT, 0)}" if error < EXACT else scientific(error, 0)


def _quoted(way: str) -> str:
    name, comma, setting = way.partition(",")
    return f"`{name}`{comma}{setting}"
