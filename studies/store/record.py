"""The record of a cell: solve it, keep its files if they are wanted, and say everything else in one JSON text."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from studies.complete import complete
from studies.request import Request
from studies.scene import UsageError
from studies.solving import UNSUPPORTED, solve
from studies.store.atomic import SCHEMA, as_text
from studies.store.provenance import provenance


def record_of(
    cell_id: str, scene_name: str, options: Mapping[str, Any], settings: Mapping[str, str], directory: Path | None
) -> str:
    """Solve a cell and tell; a scene that refuses to be built is a record, too. Raises what solving raises."""
    scene, request = complete(scene_name, settings, **options)
    head = {"schema": SCHEMA, "id": cell_id}
    try:
        result = solve(scene, request)
    except UsageError as error:
        return as_text({**head, **refused(request, str(error))})
    files = [] if directory is None or result.unsupported else result.write_artefacts(directory)
    return as_text({**head, **result.as_json(), "files": files})


def refused(request: Request, reason: str) -> dict[str, Any]:
    """A record of nothing but the reason."""
    nothing: dict[str, Any] = {"quantities": {}, "steps": [], "cuts": [], "counters": {}, "timing_s": {}, "files": []}
    told = {name: getattr(request, name) for name in ("scene", "measure", "contact", "newton", "model", "model_reason")}
    return {
        **told,
        "mesh": f"{request.mesh[0]}x{request.mesh[1]}",
        "settings": {**request.settings, "steps": request.steps},
        "outcome": UNSUPPORTED,
        "class": UNSUPPORTED,
        "reason": reason,
        **nothing,
        "provenance": provenance(),
    }
