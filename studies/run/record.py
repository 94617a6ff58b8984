"""The record of a cell: solve it, keep its files if they are wanted, and say everything else in one JSON text."""

from __future__ import annotations

from pathlib import Path

from studies.ask.request import Request, UsageError
from studies.output.atomic import SCHEMA, as_text
from studies.run.schema import as_line
from studies.scenes import SCENES
from studies.solving.result import Result
from studies.solving.solve import solve


def record_of(cell_id: str, request: Request, directory: Path | None) -> str:
    """The record of a solved request; a scene that refuses to be built is a record, too. Raises what solving raises."""
    try:
        result = solve(SCENES[request.scene], request)
    except UsageError as error:
        result = Result(request, unsupported=str(error))
    files = [] if directory is None or result.unsupported else result.write_artefacts(directory)
    record = result.as_json()
    record["reason"] = as_line(record["reason"])
    return as_text({"schema": SCHEMA, "id": cell_id, **record, "files": files})
