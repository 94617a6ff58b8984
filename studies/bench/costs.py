"""``footprint bench``: what a factorisation, a solve, the whole command and an assembly cost, in units of one work.

The unit is one factorisation of the tangent of the whole tyre on 42x40 elements, 9840 unknowns, by SuperLU. Each line
says what is done, and its bars. Tangents of the whole tyre are factorised as they are, definite; shifted, indefinite
with a known inertia; and with another section, not symmetric.
"""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pandas as pd
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, eigsh

from contact.solvers.multifrontal import Multifrontal
from contact.solvers.sparse import BACKWARD_ERROR, Factor, backward_error, factorise
from formulations.shell import ShellModel
from studies.bench.newton import asked, tyre
from studies.bench.rounds import NO_BAR, PART, Group, Line, in_rounds
from studies.run.children import ONE_THREAD
from studies.run.source_hash import ROOT
from studies.scenes.complete import complete
from studies.solving.result import Result
from studies.solving.solve import solve

MESH = "42x40"
SIZES, LARGEST = (MESH, "102x100"), "210x200"  # 10, 60 and 250 thousand unknowns
DELTA_MM = "20"
UNIT, SOLVES = "unit: the tangent of the whole tyre by SuperLU", "solve: half tyre, inflated and pressed in one step"
COMMAND, ASSEMBLY = "command", "assembly: whole tyre"
SOLVE = "start to files"
START, IMPORTS = "command imported, request read", "numpy and scipy imported"
PARTS = ("build", "assembly", "factorisation", "solve", "contact")  # of timing_s
# what a step of an exact set may spend, and where all that enforce contact exactly must end
BEYOND, FORCE_OFF, NODES_OFF = "factorisations beyond iterations", "force off semismooth", "nodes off semismooth"
FLOOR = ("-c", "import numpy, scipy.linalg, scipy.sparse.linalg")  # nothing is solved without
REFUSED = ("-m", "studies.cli", "solve", "tyre", "--mesh", "0x0", "--out", "unused")  # once all that solves is loaded
ONE_AN_ITERATION = {BEYOND: 2.0}
SAME_END = {FORCE_OFF: 1e-10, NODES_OFF: 0.0}
OVER_SPLU, OVER_PARDISO = 0.35, 2.2
LOWEST = 12  # eigenvalues that are found to shift between two of them
AT_LEAST = 3  # of them negative then
DEFINITE, INDEFINITE, GENERAL = "definite", "indefinite", "not symmetric"

ANALYSIS, NUMERIC, SOLUTION = 11, 22, 33
TYPES = {"definite": 2, "indefinite": -2, "general": 11}
# own values for all; METIS; no refinement; pivots perturbed at 1e-13; neither scaling nor matching; Bunch and Kaufman
OPTIONS = {1: 1, 2: 2, 8: 0, 10: 13, 11: 0, 13: 0, 21: 1}


def costs(
    rounds: int,
    largest: bool = False,
    progress: Callable[[int, int, str], None] = lambda done, planned, label: None,
    *,
    sizes: tuple[str, ...] = SIZES,
    mesh: str = MESH,
) -> pd.DataFrame:
    """The table of :func:`in_rounds`; ``largest``: a factorisation of 250,000 unknowns, too.

    Needs one thread (OMP_NUM_THREADS=1, as the command line sets it). Raises UsageError for a mesh it cannot have.
    """
    K = at_rest(shell_of(mesh))
    with TemporaryDirectory() as folder:
        every = groups(K, mesh, (*sizes, LARGEST) if largest else sizes, Path(folder))
        return in_rounds(every, partial(factorise, K, "splu", ordered=True), rounds, progress)


def groups(K: sparse.csc_matrix, mesh: str, sizes: tuple[str, ...], folder: Path) -> Iterator[Group]:
    """All that is measured; each is made when it is its turn."""
    orders = {"order of the grid: the unit": True, "order of least degree": False}
    each = [Line(name, partial(factorise, K, "splu", ordered=own), _ms, cold=True) for name, own in orders.items()]
    yield Group(UNIT, each)
    for size in sizes:
        yield from factorisations(size)
    yield solves(mesh)
    yield Group(
        COMMAND,
        [
            Line(IMPORTS, partial(child, FLOOR, folder)),
            Line(START, partial(child, REFUSED, folder, 2), over={IMPORTS: 1.5}),
            Line(SOLVE, partial(_command, mesh, folder), _parts_of_command, most={"units": 6.0}),
        ],
    )
    yield assembly(mesh)


def _ms(_: Any, seconds: float) -> dict[str, float]:
    return {"ms": 1e3 * seconds}


def shell_of(mesh: str, **settings: str) -> ShellModel:
    """The whole tyre of the paper; raises UsageError."""
    return tyre(asked(mesh, **settings)).shell


def at_rest(shell: ShellModel) -> sparse.csc_matrix:
    """The tangent (n, n) at u = 0, definite where it is symmetric; its unknowns are in an order of elimination."""
    return sparse.csc_matrix(shell.linearise(np.zeros(shell.discretisation.n_free)).tangent)


def shifted(K: sparse.csc_matrix) -> tuple[sparse.csc_matrix, int]:
    """K - s with s in the widest relative gap between low eigenvalues of the definite K, and how many are below it.

    They are found by Lanczos's method on K^-1 by SuperLU: fronts have no part in it.
    """
    inverse = LinearOperator(K.shape, matvec=factorise(K, "splu", ordered=True).solve, dtype=float)
    low = np.sort(eigsh(K, k=LOWEST, sigma=0.0, OPinv=inverse, return_eigenvectors=False))
    below = AT_LEAST + int(np.argmax(low[AT_LEAST:] / low[AT_LEAST - 1 : -1]))
    found = K.copy()  # a difference would lose the zeros of its pattern
    found.setdiag(K.diagonal() - np.sqrt(low[below - 1] * low[below]))
    return found, below


def factorisations(mesh: str) -> Iterator[Group]:
    """The tangents of a mesh, a group each, by fronts, SuperLU and, where it is installed, PARDISO."""
    K = at_rest(shell_of(mesh))
    yield _of_kind(DEFINITE, K)
    yield _of_kind(INDEFINITE, *shifted(K))
    yield _of_kind(GENERAL, at_rest(shell_of(mesh, section="nonsymmetric")))


def _of_kind(kind: str, A: sparse.csc_matrix, negative: int = 0) -> Group:
    b = np.random.default_rng(12).normal(size=A.shape[0])

    def see(factor: Factor, seconds: float) -> dict[str, float]:
        found = {"backward error": backward_error(A, factor.solve(b), b)}
        if isinstance(factor, Multifrontal) and kind != GENERAL:
            found |= {"negative": factor.negative, "wrong inertia": abs(factor.negative - negative)}
        return found

    over, most = {"splu": OVER_SPLU}, {"backward error": BACKWARD_ERROR, "wrong inertia": 0.0}
    lines = [Line("splu", partial(factorise, A, "splu", ordered=True), see, cold=True)]
    if with_pardiso():
        over["PARDISO"] = OVER_PARDISO
        numeric = Pardiso(A, definite=kind == DEFINITE, symmetric=kind != GENERAL)
        lines.append(Line("PARDISO", numeric.factorised, see, cold=True))
    fronts = Line("fronts", partial(factorise, A, "multifrontal", ordered=True), see, over, most)
    return Group(f"factorisation of {A.shape[0]} unknowns, {kind}", [fronts, *lines])


def with_pardiso() -> bool:
    """Whether the extra mkl is installed."""
    return importlib.util.find_spec("pypardiso") is not None


def solves(mesh: str) -> Group:
    """The algorithms, condensed and on fronts, and what both are worth; all beside semismooth."""
    reference = _solved("semismooth", mesh)

    def line(contact: str, over: Mapping[str, float], most: Mapping[str, float], **settings: str) -> Line:
        name = ", ".join([contact, *(f"{key}={value}" for key, value in settings.items())])
        return Line(name, partial(_solved, contact, mesh, **settings), partial(_seen, reference, most), over, most)

    beside, exact = {"semismooth": NO_BAR}, {**ONE_AN_ITERATION, **SAME_END}
    return Group(
        SOLVES,
        [
            line("semismooth", {"regularised": 1.0}, ONE_AN_ITERATION),
            line("lcp", {"semismooth": 1.3}, exact),
            line("qp", {"semismooth": 1.3}, exact),
            line("trial-and-error", beside, ONE_AN_ITERATION),
            line("regularised", beside, {}),
            line("augmented-lagrangian", beside, SAME_END),
            line("lcp", beside, SAME_END, system="full"),
            line("qp", beside, SAME_END, system="full"),
            line("semismooth", beside, SAME_END, solver="splu"),
        ],
    )


def assembly(mesh: str) -> Group:
    """Residual and tangent of the whole tyre as the iterations of a mixed Newton need them."""
    shell = shell_of(mesh)
    u = np.zeros(shell.discretisation.n_free)
    memory, elements = shell.linearise(u).remember(u), len(shell.discretisation.dofs)

    def see(_: Any, seconds: float) -> dict[str, float]:
        return {"us an element": 1e6 * seconds / elements}

    return Group(ASSEMBLY, [Line("residual and tangent", partial(shell.linearise, u, memory), see)])


def _solved(contact: str, mesh: str, **settings: str) -> Result:
    return solve(*complete("tyre", {"delta_mm": DELTA_MM, **settings}, mesh, model="half", contact=contact))


def _seen(reference: Result, bars: Iterable[str], result: Result, seconds: float) -> dict[str, float]:
    """What the pressed step has taken, factorisations of the column that is inflated left out, and where it ends."""
    step, there = result.loads[-1], reference.loads[-1]
    assert result.last is not None
    assert reference.last is not None
    iterations, factorisations = step.counters["newton_iterations"], step.counters["factorisations"]
    force = step.quantities["force_N"]
    judged = {
        BEYOND: factorisations - iterations,
        FORCE_OFF: abs(force / there.quantities["force_N"] - 1),
        NODES_OFF: int(np.sum(result.last.active ^ reference.last.active)),
    }
    spent = {"iterations": iterations, "factorisations": factorisations, "force_N": force}
    return {**spent, **{name: judged[name] for name in bars}, **_parts(result.timing)}


def _parts(timing: Mapping[str, float]) -> dict[str, float]:
    """Processor time of a solve in parts; they are known by the clock, and waited for the processor all alike."""
    shares = {f"{PART}{name}_s": timing[name] / timing["total"] * timing["cpu"] for name in PARTS}
    return {**shares, f"{PART}rest_s": timing["cpu"] - sum(shares.values())}


def _command(mesh: str, folder: Path) -> dict[str, float]:
    """Timing of the result that the command has written."""
    words = ["solve", "tyre", "--mesh", mesh, "--model", "half", "--set", f"delta_mm={DELTA_MM}", "--out"]
    child(("-m", "studies.cli", *words, str(folder / "out")), folder)
    return dict(json.loads((folder / "out" / "result.json").read_text(encoding="utf-8"))["timing_s"])


def _parts_of_command(timing: Mapping[str, float], seconds: float) -> dict[str, float]:
    return {f"{PART}start and files_s": seconds - timing["cpu"], **_parts(timing)}


def child(words: Sequence[str], compiled: Path, code: int = 0) -> None:
    """Run Python on one thread to the end, with this exit code; what it compiles is kept, as on installation."""
    path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = {**os.environ, **ONE_THREAD, "PYTHONPATH": path, "PYTHONPYCACHEPREFIX": str(compiled / "compiled")}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    done = subprocess.run([sys.executable, "-P", *words], env=environment, capture_output=True, check=False)
    assert done.returncode == code, done.stderr


class Pardiso:
    """PARDISO at its best, as a rival of fronts: a matrix of its type that is analysed once, and factorised many times.

    The solver ``pardiso`` of a solve analyses each matrix anew, and takes all for matrices that are not symmetric.
    """

    def __init__(self, A: sparse.csc_matrix, *, definite: bool, symmetric: bool) -> None:
        kind = "definite" if definite else "indefinite" if symmetric else "general"
        from pypardiso import PyPardisoSolver

        self._solver = PyPardisoSolver(mtype=TYPES[kind])
        for index, value in OPTIONS.items():
            self._solver.set_iparm(index, value)
        rows = sparse.csr_matrix(sparse.triu(A) if symmetric else A)
        rows.sort_indices()
        self._matrix, self._nothing = rows, np.zeros(A.shape[0])
        self._phase(ANALYSIS, self._nothing)

    def factorised(self) -> Pardiso:
        """The numbers of L and U, in the places known."""
        self._phase(NUMERIC, self._nothing)
        return self

    def solve(self, b: np.ndarray) -> np.ndarray:
        """x with A x = b."""
        return self._phase(SOLUTION, b)

    def _phase(self, phase: int, b: np.ndarray) -> np.ndarray:
        self._solver.set_phase(phase)
        return np.asarray(self._solver._call_pardiso(self._matrix, b))

    def __del__(self) -> None:
        self._solver.free_memory(everything=True)
