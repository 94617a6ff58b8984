"""Section "What small strain in the law is worth": laws beside one another on bodies that carry in different ways."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from reports.figures.drawing import BLACK, canvas, looks, svg
from reports.formats import digits, share
from reports.markdown import Part, joined, listing, picture, prose
from reports.store.tables import Store


def law_part(store: Store) -> Part:
    """The whole section."""
    offsets, rules = store.analysis("law_offsets"), store.analysis("law_rules")
    worst = rules.groupby("carries")["factor"].max()
    membrane, bending = float(worst["membrane"]), float(worst["bending"])
    words = prose(f"""## What small strain in the law is worth

The law of a shell is linear in Green's strain, so it holds for small strain. The same solids with that law and with
Hencky's, on one mesh, turn the caveat into a number. With the largest logarithmic strain e in the body, the law changes
what is computed by at most {digits(membrane, 2)} e where a wall carries by stretching, and by at most
{digits(bending, 2)} e where it bends: 1 % is there at a strain of {share(0.01 / membrane, 1)} or of
{share(0.01 / bending, 1)}, and not before. To first order the strain of a membrane under a given load differs by 3 e of
itself; a wall that bends is stretched on one side as much as it is compressed on the other, and the first order cancels
but for what the shift of the load and the thickness of the wall leave.""")
    heads = "body | what is compared | load | largest strain | svk over hencky - 1 | svk over neo-hooke - 1 | factor"
    line = "{specimen} | {quantity} | {load:g} | {strain:.4f} | {off_hencky:+.2%} | {off_neo_hooke:+.2%} | {factor:.2g}"
    ruled = "body | carries by | strains | largest factor | 1 % at a strain of | power of the strain"
    rule = "{specimen} | {carries} | {least_strain:.3f} … {largest_strain:.3f} | {factor:.2g} | {percent_at:.1%} | "
    rule += "{power:.1f}"
    return joined(
        words,
        picture("law-strain.svg", "Change by the law over the largest strain", draw_laws(offsets)),
        listing(
            "Rules of thumb; factor: the change from hencky to svk over the largest strain", rules, ruled, rule, words=2
        ),
        listing("Every load", offsets, heads, line, words=2),
    )


@svg
def draw_laws(offsets: pd.DataFrame) -> Figure:
    """Change by the law over the strain, a line a body: solid membranes, dashed bending; dotted: 3 e."""
    figure, (axes,) = canvas(width=8.0, height=5.0)
    for name, look in looks(offsets["specimen"]).items():
        own = offsets[offsets["specimen"] == name].sort_values("strain")
        line = "-" if own["carries"].iloc[0] == "membrane" else "--"
        axes.loglog(
            own["strain"], own["off_hencky"].abs(), color=look.colour, marker=look.marker, linestyle=line, label=name
        )
    ends = [offsets["strain"].min(), offsets["strain"].max()]
    axes.loglog(ends, [3 * end for end in ends], color=BLACK, linestyle=":", label="3 e")
    axes.axhline(0.01, color=BLACK, linewidth=0.8)
    axes.set(xlabel="largest logarithmic strain e", ylabel="|svk over hencky - 1|")
    axes.legend()
    return figure
