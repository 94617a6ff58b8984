"""Picture of the strain measures: errors over the load; returns SVG text."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from reports.drawing import BLACK, canvas, looks, style, to_svg


def errors_over_load(data: pd.DataFrame, words: Mapping[str, str]) -> str:
    """Size of the errors over the load, one panel a scene: columns scene, measure, load, error; words: of the loads."""
    drawn = looks(data["measure"])
    scenes = dict(iter(data.groupby("scene", sort=False)))
    with style():
        rows = -(-len(scenes) // 3)
        figure, panels = canvas(-(-len(scenes) // rows), height=1.2 + 2.8 * rows, rows=rows)
        for axes, (scene, own) in zip(panels, scenes.items(), strict=True):
            for name, look in drawn.items():
                curve = own[own["measure"] == name]
                if len(curve):
                    size = curve["error"].abs()
                    axes.plot(curve["load"], size.where(size > 0), **look.dashes, label=name)
            for level in (0.01, 0.05):
                axes.axhline(level, color=BLACK, linewidth=0.8, linestyle=":")
            axes.set(title=scene, xlabel=words[str(scene)], yscale="log", ylim=(1e-5, 2), xlim=(0, None))
        figure.supylabel("error against the exact measure [-]", fontsize=10)
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=4)
        return to_svg(figure)
