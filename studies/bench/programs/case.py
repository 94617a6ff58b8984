"""One scene that other programs solve from our decks: settings, meshes of bricks from coarse to fine, and our mesh.

Which scenes there are is in :mod:`.cases`: a list that grows must not make anew what was run.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from studies.exchange.deck import AUTO


@dataclass(frozen=True)
class Case:
    """One scene; ``name`` is that of the problem of ``bench peers`` where that has the same.

    meshes: bricks along a1 and a2, from coarse to fine.  ours: mesh of our solution.  held: whether the rule of one
    direction of plies a brick is checked by our own solid.
    """

    name: str
    meshes: tuple[str, ...]
    ours: str
    settings: Mapping[str, str] = field(default_factory=dict)
    measure: str = "exact"
    scene: str = ""
    integration: str = AUTO
    held: bool = False

    @property
    def of(self) -> str:
        """Name of its scene in the catalogue."""
        return self.scene or self.name
