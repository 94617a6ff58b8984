"""The part of the page of cost that says how far counted operations predict seconds."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reports.figures.drawing import BLACK, BLUE, canvas, svg
from reports.formats import fixed, share
from reports.markdown import Part, joined, listing, machine, picture, prose
from reports.store.tables import Store

NEEDED = ("predicted_seconds", "predicted_shares", "operation_rates")


def predicted_part(store: Store) -> Part:
    """Nothing where too few cells are solved for it."""
    if not all(map(store.has_analysis, NEEDED)):
        return Part("")
    cells, shares, rates = (store.analysis(name) for name in NEEDED)
    shares = shares.assign(scene=shares["scene"].fillna(""))
    whole = shares[shares["scene"] == ""].iloc[0]
    text = prose("""## Operations and seconds

Operations are counted where they are done: of the elements by the shapes of what is multiplied, of factorisations,
solutions and condensed columns by their factors, of dense pivots and quadratic programmes by their iterations; what
checks an answer is counted, too. They are the same on every machine. To predict seconds, each kind has a rate of
its own; factorisations, assemblies, load steps and the iterations of each contact algorithm take their calls beside.
The law is fitted to one half of the cells of each scene and checked on the other, and the other way round.""")
    told = prose(f"""Of {whole["cells"]:.0f} cells of {fixed(1000 * whole["least"], 0)} ms or more, the operations
predict the seconds of {share(whole["share"], 0)} within a factor of {whole["factor"]:g}; predicted over measured lies
between {fixed(whole["low"], 2)} and {fixed(whole["high"], 2)} in nine of ten.""")
    heads, line = "scene | cells | within | 5 % | median | 95 %", "{scene:named} | {cells} | {share:.0%} | "
    by_scene = listing(
        "Predicted over measured seconds", shares, heads, line + "{low:.2f} | {median:.2f} | {high:.2f}", named=_named
    )
    known = "what | a unit | seconds each | share of all seconds"
    laws = listing(
        "Rates", rates, known, "{what:worded} | {kind} | {seconds_each:.3g} | {share:.0%}", words=2, worded=_worded
    )
    drawn = picture(
        "cost-predicted.svg", "Predicted over measured seconds of all cells", predicted(cells, float(whole["factor"]))
    )
    return joined(text, machine(told, by_scene, laws), drawn)


def _named(scene: str) -> str:
    return f"`{scene}`" if scene else "all"


def _worded(name: str) -> str:
    return name.replace("_", " ")


@svg
def predicted(cells: pd.DataFrame, factor: float) -> Figure:
    """Seconds by the law over seconds measured, and how often they are apart by how much."""
    figure, (left, right) = canvas(2, width=10.0, height=4.2)
    seconds, guessed = (cells[name].to_numpy(float) for name in ("seconds", "predicted"))
    left.scatter(seconds, guessed, s=5, color=BLUE, alpha=0.35, linewidths=0)
    ends = np.array([0.8 * min(seconds.min(), guessed.min()), 1.25 * max(seconds.max(), guessed.max())])
    for times, style in ((1.0, "-"), (factor, ":"), (1 / factor, ":")):
        left.plot(ends, times * ends, color=BLACK, linewidth=1, linestyle=style)
    left.set(xscale="log", yscale="log", xlim=ends, ylim=ends, xlabel="measured [s]", ylabel="predicted [s]")
    ratios = np.sort(guessed / seconds)
    right.step(ratios, np.arange(1, len(ratios) + 1) / len(ratios), where="post", color=BLUE)
    for times in (factor, 1 / factor):
        right.axvline(times, color=BLACK, linewidth=1, linestyle=":")
    right.set(xscale="log", xlim=(0.25, 4), ylim=(0, 1.02), xlabel="predicted over measured", ylabel="share of cells")
    right.set_xticks(
        [0.25, 0.5, 1 / factor, 1, factor, 2, 4], ["1/4", "1/2", f"1/{factor:g}", "1", f"{factor:g}", "2", "4"]
    )
    right.minorticks_off()
    return figure
