"""The page of cost: what a smaller model and a better grid save, and what one Newton step costs."""

from __future__ import annotations

from reports.chapter import Chapter
from reports.chapters.trade.advice import advice_part
from reports.chapters.trade.figures_cost import precision
from reports.chapters.trade.statements import statements_part
from reports.chapters.tyre.cells import DELTA, PLIES
from reports.formats import fixed, number, scientific, share
from reports.markdown import Part, commands, joined, listing, machine, picture, prose
from reports.store.tables import Store


def cost_page(store: Store) -> Part:
    """The whole page."""
    introduction = prose("""# Cost and accuracy

What a part of a body, a better grid and an error that is asked for cost, and what advice from stored campaigns is
worth. What to use for a problem stands on [page one](index.md). Times are processor time of one run each; what is
compared is their ratio.""")
    return joined(introduction, _models(store), _precision(store), statements_part(store), advice_part(store))


def _models(store: Store) -> Part:
    """Parts of the tyre beside the whole."""
    found, same_at = store.analysis("tyre_models"), store.rules()["same_model"]
    parts, records = found[found["model"] != "full"], []
    for row in found.to_dict("records"):
        result = store.find(group="models", plies=PLIES[row["plies"]], model=row["model"], mesh=row["mesh"]).result
        records.append({**row, **result["counters"]})

    def off(value: float) -> str:
        return f"under {scientific(same_at, 0)}" if value <= same_at else scientific(value)

    heads = "plies | model | unknowns | iterations | factorisations | operations | "
    heads += "error of the force | of pressures"
    line = "{plies} | `{model}` | {dofs} | {newton_iterations} | {factorisations} | {operations_share:.0%} | "
    line += "{force_off:off} | {pressure_off:off}"
    delta = fixed(DELTA, 0)
    text = prose(f"""## Do less: a part of the tyre

Inflation is the same all around and is solved on one column of elements; pressed to {delta} mm on a mesh of
{found["mesh"].iloc[0]}, a tyre with angle plies is a half under a turn by 180° about the contact normal, one without
is a quarter between two mirror planes. {parts["same"].sum()} of {len(parts)} parts give the force, the pressures and
the contact set of the whole to {scientific(same_at, 0)} of their value. `--model auto` takes the smallest valid one; a
mirror is refused for angle plies.""")
    steady = listing(f"Inflation and {delta} mm, against the whole", records, heads, line, words=2, off=off)
    return joined(text, steady, commands(found["command"]))


def _precision(store: Store) -> Part:
    """Force against unknowns on tensor grids and on locally refined ones."""
    needed, grids = store.analysis("grids_reaching"), store.table("work_precision")
    against, errors = grids.iloc[0], list(dict.fromkeys(needed["within"]))
    asked = " and ".join(map(bound, errors))
    unsure = [bound(error) for error in errors if error < against["known"]]
    doubt = f" Whether a grid reaches {' or '.join(unsure)}, which is less, is not decided." if unsure else ""
    text = prose(f"""## Put the elements where the force is decided

Force of the paper's tyre at {fixed(DELTA, 0)} mm over the unknowns, on families of grids: `uniform`; `patch`, the
spacing of the paper, finer around the patch; `adapted`, lines that follow an estimate of the error of the force from
two coarse solutions; `local`, single elements cut where the force is decided;
`extrapolated`, the limit that each round of `local` states from its grid and the one with all elements cut, over the
unknowns of the latter; the last one is half of what the elements are apart off by definition. Errors are against the
mean of the last such limits of both elements, {fixed(against["reference_N"], 1)} N: they are
{share(against["apart"])} apart, and the mean is known to {share(against["known"])}, grey below that.{doubt} A force
goes up and down with the place of the rim of the patch
between the lines, so that a single good grid may be chance: a grid *reaches* an error when all finer ones of its
family, {store.rules()["behind"]:g} of them at least, stay below it.""")
    heads = "error | element | grid | first mesh | unknowns | of uniform | force [N] | off"
    line = "{within:bound} | `{element}` | `{family}` | {mesh:said} | {unknowns:.0f} | {share:.0%} | {force_N:.1f} | "
    line += "{error:+.2%}"
    body = listing(f"Grids that reach {asked}", needed.fillna({"mesh": ""}), heads, line, words=3, bound=bound)
    known, title = needed[needed["unknowns"].notna()], f"CPU seconds of the grids that reach {asked}"
    spent, times = "error | element | grid | alone [s] | total [s]", "{within:bound} | `{element}` | `{family}` | "
    times += "{own_s:.2f} | {total_s:.2f}"
    own = prose("""*Total*: with all that is needed to get there, the estimate of an adapted grid or the rounds before a
local one, their finer grids and indicators included.""")
    listed = listing(title, known, spent, times, words=3, bound=bound)
    timed = machine(own, listed)
    drawn = picture(
        "cost-precision.svg",
        "Error of the force over the unknowns, by grid; lines: the largest of a grid and all finer ones",
        precision(grids, errors),
    )
    return joined(text, body, timed, drawn)


def bound(error: float) -> str:
    """An error that is asked for."""
    return f"{number(100 * error)} %"


CHAPTER = Chapter(
    "cost",
    "Cost and accuracy",
    "what a part of a body saves, what a better grid saves, how honest stated errors are, and what advice is worth.",
    cost_page,
    needs=("rules", "work_precision", "grids_reaching", "tyre_models"),
    always=True,
)
