"""Problems with friction in the text format of Siconos (numerics, FrictionContact): read, never written.

Two kinds, v velocities or displacements, u relative ones of the contacts, l forces, per contact a normal component and
one (d = 2) or two (d = 3) tangential ones; 0 <= u_n, l_n >= 0, u_n l_n = 0, and Coulomb's law with mu::

    local     u = W l + q                               d, contacts, W, q, mu
    global    M v = H l + q,    u = H^T v + b           d, contacts, M, H, q, b, mu

A matrix is its storage (0 dense, 1 sparse blocks, 2 sparse), its rows and columns, and its entries, those of dense
matrices and blocks column by column, sparse ones as CSparse prints them, with six digits. A problem is global where a
second matrix follows. What stands after mu is not read: other programs' guesses and answers.

As a step with friction the global problem is what it is, K = M. The local one has no unknowns but forces, and W is as
often singular as not: more contacts than rigid bodies have freedoms. Where W = L L^T, it is the global problem with
M = 1 and H^T = L, with as many unknowns as the rank of W: definite whatever W, and what forces do is W and no more.
Another W = Q B Q^T, Q an orthonormal basis of its columns and its rows alike, has M = B^-1 and H^T = Q. In a plane the
second direction has a spring of its own on every contact, which nothing pulls.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import sparse

from contact.interchange.linearised_step import FrozenFrictionalStep
from contact.solvers.sparse import symmetric

DENSE, BLOCKS, SPARSE = "012"
HDF5 = b"\x89HDF"
LARGEST = 5000  # rows of W that are decomposed
PRINTED = 1e-5  # of the largest eigenvalue: a negative one that six printed digits may make
LOST = 1e-12  # of the largest: one that is none; in the files none lies between 1e-10 and 1e-15 where W is singular


class SiconosError(ValueError):
    """A file that is not a problem of Siconos, or one that no step can be made of; the message is one line."""


@dataclass(frozen=True, eq=False)
class SiconosProblem:
    """Dimension d, mu (m,), ``offset`` q or b (dm,), W (dm, dm) or None, or M (n, n), H (n, dm) and q (n,) or None."""

    d: int
    mu: np.ndarray
    offset: np.ndarray
    W: sparse.csc_matrix | None = None
    M: sparse.csc_matrix | None = None
    H: sparse.csc_matrix | None = None
    q: np.ndarray | None = None

    @property
    def kind(self) -> str:
        """``local`` or ``global``."""
        return "global" if self.W is None else "local"

    def step(self) -> FrozenFrictionalStep:
        """As a step with friction, areas one; raises SiconosError where it is none."""
        if self.M is not None and self.H is not None and self.q is not None:
            return self._with(self.M, self.H, self.q, float(np.linalg.norm(self.q)))
        assert self.W is not None
        if self.W.shape[0] > LARGEST:
            raise SiconosError(f"W has {self.W.shape[0]} rows, and is decomposed up to {LARGEST}")
        K, H, force = (_symmetric if symmetric(self.W) else _general)(self.W.toarray())
        return self._with(K, H, np.zeros(K.shape[0]), force * float(np.linalg.norm(self.offset)))

    def _with(
        self,
        K: sparse.csc_array | sparse.csc_matrix,
        H: sparse.csc_array | sparse.csc_matrix,
        f: np.ndarray,
        size: float,
    ) -> FrozenFrictionalStep:
        """K v = H l + f with forces of the given size."""
        m, n = len(self.mu), K.shape[0]
        rows, offset = sparse.csr_matrix(H.T), self.offset.reshape(m, self.d)
        slip, tangential = np.zeros((m, 2)), (self.d * np.arange(m)[:, None] + np.arange(1, self.d)).ravel()
        slip[:, : self.d - 1] = offset[:, 1:]
        G, S = rows[self.d * np.arange(m)], rows[tangential]
        if self.d == 2:
            own = np.full(m, float(np.median(np.abs(K.diagonal()))) if n else 1.0)
            K = sparse.csc_matrix(sparse.block_diag([K, sparse.diags_array(own)]))
            G = sparse.csr_matrix(sparse.hstack([G, sparse.csr_matrix((m, m))]))
            both = sparse.csr_matrix(sparse.block_diag([S, sparse.eye_array(m)]))
            S = both[np.column_stack([np.arange(m), m + np.arange(m)]).ravel()]
            f = np.append(f, np.zeros(m))
        contact = sparse.csc_matrix(K), -f, sparse.csr_matrix(G), offset[:, 0].copy(), np.ones(m), size
        return FrozenFrictionalStep(*contact, S=sparse.csr_matrix(S), slip=slip, mu=self.mu)


def _symmetric(W: np.ndarray) -> tuple[sparse.csc_matrix, sparse.csc_matrix, float]:
    """K, H of W = H^T K^-1 H, and the force of a unit of displacement."""
    values, vectors = np.linalg.eigh((W + W.T) / 2)
    largest = float(values[-1])
    if not (largest > 0 and values[0] >= -PRINTED * largest):
        raise SiconosError(f"W is not positive: its eigenvalues go from {values[0]:.1e} to {largest:.1e}")
    kept = values > max(LOST * largest, -2 * float(values[0]))  # what is negative shows how wrong the others are
    H = sparse.csc_matrix((vectors[:, kept] * np.sqrt(values[kept])).T)
    return sparse.csc_matrix(sparse.eye_array(H.shape[0])), H, 1 / np.sqrt(largest)


def _general(W: np.ndarray) -> tuple[sparse.csc_matrix, sparse.csc_matrix, float]:
    """The same for a W that is not symmetric; columns and rows must span one space."""
    left, sizes, _ = np.linalg.svd(W)
    Q = left[:, sizes > LOST * sizes[0]]
    B = Q.T @ W @ Q
    if not np.max(np.abs(W - Q @ B @ Q.T)) <= LOST * sizes[0]:
        raise SiconosError("W is singular and not symmetric, and its columns span another space than its rows")
    return sparse.csc_matrix(np.linalg.inv(B)), sparse.csc_matrix(Q.T), 1 / float(sizes[0])


def read(path: Path) -> SiconosProblem:
    """The problem in a file; raises SiconosError for whatever else is in it, OSError when it cannot be opened."""
    content = path.read_bytes()
    if content.startswith(HDF5):
        raise SiconosError(f"{path} is an HDF5 file of FCLib, and only text is read")
    try:
        return parse(content.decode("utf-8"))
    except (ValueError, IndexError) as error:
        reason = str(error).splitlines()[0] if str(error) else "it ends too early"
        raise SiconosError(f"{path} is not a frictional problem of Siconos: {reason}") from None


def parse(text: str) -> SiconosProblem:
    """The problem in a text; raises ValueError for any other."""
    words = _Words(text.split())
    d, m = words.whole(), words.whole()
    if d not in (2, 3) or m < 1:
        raise ValueError(f"{m} contacts in {d} dimensions: at least one is needed, in 2 or 3")
    first = words.matrix()
    n, rows = first.shape
    if n != rows:
        raise ValueError(f"a matrix of {n} x {rows} that has to be square")
    if words.next_matrix_is(n, d * m):
        H = words.matrix()
        q, b, mu = words.numbers(n), words.numbers(d * m), words.numbers(m)
        problem = SiconosProblem(d, mu, b, M=first, H=H, q=q)
    elif n == d * m:
        q, mu = words.numbers(n), words.numbers(m)
        problem = SiconosProblem(d, mu, q, W=first)
    else:
        raise ValueError(f"a matrix of {n} rows for {m} contacts in {d} dimensions, and no second one")
    if np.any(problem.mu < 0):
        raise ValueError("a coefficient of friction is negative")
    return problem


class _Words:
    """A text, word by word."""

    def __init__(self, words: list[str]) -> None:
        self._words, self._at = words, 0

    def take(self) -> str:
        """The next word."""
        self._at += 1
        return self._words[self._at - 1]

    def whole(self) -> int:
        """The next word, a whole number."""
        return int(self.take().rstrip(","))

    def wholes(self, count: int) -> np.ndarray:
        """As many whole numbers (count,)."""
        return np.array([self.whole() for _ in range(count)], dtype=int)

    def numbers(self, count: int) -> np.ndarray:
        """As many finite numbers (count,)."""
        values = np.array(self._words[self._at : self._at + count], dtype=float)
        if len(values) < count or not np.all(np.isfinite(values)):
            raise ValueError(f"{len(values)} of {count} finite numbers")
        self._at += count
        return values

    def next_matrix_is(self, rows: int, columns: int) -> bool:
        """Whether the head of a matrix of that shape comes next."""
        storage, *shape = self._words[self._at : self._at + 3]
        return storage in (DENSE, BLOCKS, SPARSE) and shape == [str(rows), str(columns)]

    def matrix(self) -> sparse.csc_matrix:
        """The next matrix."""
        storage, shape = self.take(), (self.whole(), self.whole())
        if storage == DENSE:
            if (self.whole(), self.whole()) != shape:
                raise ValueError(f"a dense matrix of two shapes, one of them {shape}")
            return sparse.csc_matrix(self.numbers(shape[0] * shape[1]).reshape(shape, order="F"))
        if storage == BLOCKS:
            return self._blocks(shape)
        if storage == SPARSE:
            return self._printed(shape)
        raise ValueError(f"a matrix of the storage {storage}: 0, 1 and 2 are read")

    def _blocks(self, shape: tuple[int, int]) -> sparse.csc_matrix:
        """Blocks in compressed rows: their ends by row and column, pointers, column numbers, then each with its own."""
        count, high, wide = self.whole(), self.whole(), self.whole()
        rows, columns = (np.append(0, self.wholes(k)) for k in (high, wide))
        pointers, filled = self.whole(), self.whole()
        starts, places = self.wholes(pointers), self.wholes(filled)
        if (rows[-1], columns[-1]) != shape or filled != count or starts[-1] != count:
            raise ValueError(f"{count} blocks that do not fill a matrix of {shape}")
        entries = [np.zeros((3, 0))]
        for k, row in enumerate(np.repeat(np.arange(pointers - 1), np.diff(starts))):
            if self.whole() != k:
                raise ValueError(f"block {k} is not where it belongs")
            i = np.arange(rows[row], rows[row + 1])
            j = np.arange(columns[places[k]], columns[places[k] + 1])
            entries.append(np.stack([np.tile(i, len(j)), np.repeat(j, len(i)), self.numbers(len(i) * len(j))]))
        return _assembled(np.hstack(entries), shape)

    def _printed(self, shape: tuple[int, int]) -> sparse.csc_matrix:
        """As printed by CSparse: triplets "i j : v", or columns "col j : locations a to b" with lines "i : v"."""
        word = ""
        while not (said := re.fullmatch(r"(\d+)-by-(\d+),", word)):
            before, word = word, self.take()
        if (int(said[1]), int(said[2])) != shape or before == "csr:":
            raise ValueError(f"a sparse matrix of {said[0]} {before} that is to be one of {shape} by columns")
        self.take()
        self.take()
        self.take()
        count = self.whole()
        if before == "triplet:":
            words = self._words[self._at : self._at + 4 * count]
            self._at += 4 * count
            return _assembled(np.array([words[0::4], words[1::4], words[3::4]], dtype=float), shape)
        self.take()
        self.take()
        entries = []
        for column in range(shape[1]):
            start, end = (self._words[self._at + k] for k in (4, 6))
            self._at += 7
            words = self._words[self._at : self._at + 3 * (int(end) + 1 - int(start))]
            self._at += len(words)
            entries += [(i, column, v) for i, v in zip(words[0::3], words[2::3], strict=True)]
        if len(entries) != count:
            raise ValueError(f"{len(entries)} of {count} entries of a sparse matrix")
        return _assembled(np.array(entries, dtype=float).reshape(-1, 3).T, shape)


def _assembled(entries: np.ndarray, shape: tuple[int, int]) -> sparse.csc_matrix:
    """Of rows, columns and values (3, count); raises ValueError for places outside and values not finite."""
    i, j, v = entries
    if not np.all(np.isfinite(v)):
        raise ValueError("an entry of a matrix is not finite")
    return sparse.csc_matrix((v, (i.astype(int), j.astype(int))), shape=shape)
