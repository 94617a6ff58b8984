"""A field as it was written for ParaView, read back into the unknowns of a model that is built here.

Only files of the form of :mod:`studies.store.vtu` are read, array by array, none larger than the model asks for. What
the unknowns mean, and whether they are in equilibrium, does not enter here.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from contact.problem import ContactSolution, Outcome
from formulations.discretisation import Discretisation
from formulations.solid.body import SolidDiscretisation
from studies.scene import SceneModel, ShellSceneModel, candidates_at
from studies.store.vtu import PackedArray, packed_arrays
from studies.trust.foreign import ClaimError

RESULTANT = "H_"  # how the names of resultants begin
SAME = 1e-12  # of the largest value of an array: writing a field and reading it back
RESULTANTS = 1e-6  # of the largest one: small differences of large displacements

Arrays = Mapping[str, np.ndarray]


def as_written(model: SceneModel, state: ContactSolution) -> tuple[bytes, Arrays]:
    """The file that the model writes of a state, and its arrays."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fields.vtu"
        model.write_fields(path, state)
        text = path.read_bytes()
    return text, {name: packed.values.ravel() for name, packed in packed_arrays(text).items()}


def arrays_of(text: bytes, wanted: Arrays) -> dict[str, np.ndarray]:
    """The arrays by name, each with the type and as many values as in ``wanted``; raises ClaimError."""
    there = packed_arrays(text)
    if there.keys() != wanted.keys():
        raise ClaimError("field", f"has the arrays {', '.join(there) or 'of nothing'}, not {', '.join(wanted)}")
    return {name: _unpacked(there[name], wanted[name], name) for name in wanted}


def _unpacked(packed: PackedArray, wanted: np.ndarray, name: str) -> np.ndarray:
    """One array (k,), unpacked no further than wanted: what says that it is small may be huge."""
    most = wanted.nbytes
    try:
        data = packed.unpacked(most + 1)
    except ValueError as error:
        raise ClaimError("field", f"{name} cannot be unpacked: {error}") from None
    if len(data) != most or wanted.dtype != packed.dtype:
        has = f"more than {most}" if len(data) > most else str(len(data))
        raise ClaimError("field", f"{name} has {has} bytes, {most} belong to this mesh")
    return np.frombuffer(data, packed.dtype)


def state_of(model: SceneModel, arrays: Arrays, m: int) -> ContactSolution:
    """The state with m candidates whose field this is; raises ClaimError for a field that the model cannot have.

    The unknowns are read off the nodes that own them. The field that they give must be this one: with supports, images,
    hanging nodes, points, candidates and resultants.
    """
    for name, values in arrays.items():
        if not np.all(np.isfinite(values)):
            raise ClaimError("field", f"{name} has {int(np.sum(~np.isfinite(values)))} values that are no numbers")
    body, nodes = _body(model)
    moved = arrays["displacement"].reshape(-1, 3)
    if isinstance(body, Discretisation):
        frame = body.surface.frame(*body.grid.nodes.T)
        faces = np.split(moved, 2)
        v = np.empty((len(frame), 6))
        for face in (0, 1):
            v[:, face::2] = np.einsum("nix,nx->ni", frame, faces[face])
        u, outer = body.map.restrict(v), np.split(arrays["pressure"], 2)[1]
    else:
        u, outer = moved.ravel()[body.free], arrays["pressure"]
    pressure = np.zeros(m)
    touching = np.flatnonzero(nodes >= 0) if m else np.zeros(0, int)
    pressure[nodes[touching]] = outer[touching]
    state = ContactSolution(u, pressure, pressure > 0, Outcome.CONVERGED)
    for name, ours in as_written(model, state)[1].items():
        _agree(name, arrays[name], ours, RESULTANTS if name.startswith(RESULTANT) else SAME, arrays)
    return state


def _agree(name: str, told: np.ndarray, ours: np.ndarray, share: float, arrays: Arrays) -> None:
    alike = [each for each in arrays if each.startswith(RESULTANT)] if name.startswith(RESULTANT) else [name]
    size = max(float(np.max(np.abs(arrays[each]), initial=0.0)) for each in alike)
    off = float(np.max(np.abs(told - ours), initial=0.0))
    if off > share * size:
        of = {"Points": "the mesh of the request", "displacement": "its supports", "pressure": "its candidates"}
        belongs = of.get(name, "its displacements")
        raise ClaimError("field", f"{name} differs by {off:.3g} from what belongs to {belongs}")


def _body(model: SceneModel) -> tuple[Discretisation | SolidDiscretisation, np.ndarray]:
    """What the unknowns are of, and the candidate of each node; raises ClaimError where no field can be read back."""
    if isinstance(model, ShellSceneModel):
        return model.shell.discretisation, model.candidate_of_node
    told: Any = model
    body = getattr(getattr(told, "body", None), "discretisation", None)
    if not isinstance(body, SolidDiscretisation):
        raise ClaimError("field", "of this scene cannot be read back")
    return body, candidates_at(told.nodes, len(body.mesh.x))
