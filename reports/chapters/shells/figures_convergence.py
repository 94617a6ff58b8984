"""Pictures of convergence: mesh errors over the element size with their orders; returns SVG text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reports.drawing import BLACK, LINES, MARKERS, canvas, look, style, to_svg


@dataclass(frozen=True)
class Curve:
    """Relative mesh errors of a quantity of a scene over the sizes of the elements, coarse to fine."""

    scene: str
    quantity: str
    order: str
    sizes: Sequence[float]
    errors: Sequence[float]
    asymptotic: bool


def mesh_errors(curves: Sequence[Curve]) -> str:
    """Errors over the element size, as a share of that of the coarsest mesh, log-log.

    A colour is a scene, a line and a marker one of its quantities, a full marker a sequence in its asymptotic range.
    Dotted black: first and second order.
    """
    scenes = list(dict.fromkeys(curve.scene for curve in curves))
    drawn = dict.fromkeys(scenes, 0)
    with style():
        figure, (axes,) = canvas(width=8.5, height=4.2)
        for curve in curves:
            i, j = scenes.index(curve.scene), drawn[curve.scene]
            drawn[curve.scene] += 1
            drawn_as = {
                "color": look(i).colour,
                "marker": MARKERS[j % len(MARKERS)],
                "linestyle": LINES[j % len(LINES)],
            }
            drawn_as["fillstyle"] = "full" if curve.asymptotic else "none"
            h = np.asarray(curve.sizes) / curve.sizes[0]
            name = f"{curve.scene}, {curve.quantity}: {curve.order}"
            axes.loglog(h, np.abs(np.asarray(curve.errors)), **drawn_as, label=name)
        finest = min(curve.sizes[-1] / curve.sizes[0] for curve in curves)
        top = 2 * max(abs(curve.errors[0]) for curve in curves)
        for order in (1, 2):
            axes.loglog([finest, 1], [top * finest**order, top], color=BLACK, linestyle=":", linewidth=1)
            axes.text(0.97 * finest, top * finest**order, f"order {order}", ha="right", va="center", fontsize=8)
        ticks = [1 / k for k in (1, 2, 3, 4, 6, 8) if 1 / k > 0.99 * finest]
        axes.set_xticks(ticks, [f"1/{1 / tick:.0f}" if tick < 1 else "1" for tick in ticks])
        axes.set_xticks([], minor=True)
        axes.set(xlabel="element size over that of the coarsest mesh", ylabel="relative mesh error")
        axes.set_xlim(0.65 * finest, 1.15)
        figure.legend(loc="outside right upper", fontsize=8)
        return to_svg(figure)
