"""What is said of stability: the count against dense algebra, and of slender elements against a finer grid."""

from __future__ import annotations

from contact.solvers.sparse import symmetric
from studies.fuzz.attempt import CONVERGED, Attempt, Broken, attempt, quiet
from studies.fuzz.comparing import Answer, signs
from studies.result import UNSTABLE, Result

DENSE = 3000  # unknowns beyond which nothing is counted by dense algebra
SLENDER = 8.0  # sides of elements, or numbers of them, whose ratio is at least so much


def as_told(found: Result, answer: Answer) -> None:
    """Raises Broken where the certificate counts other negative eigenvalues than dense algebra does.

    Of an unsymmetric tangent they are not counted by its symmetric part, and a traced curve ends elsewhere.
    """
    told = found.loads[-1].certificate.get("stability", {}) if found.loads else {}
    K = answer.problem.linearise(answer.state.u, None).tangent
    if (
        told.get("negative") is None
        or K.shape[0] > DENSE
        or not symmetric(K)
        or found.end is None
        or found.end.trace is not None
    ):
        return
    with quiet():
        negative, unsigned = signs(answer, answer.state.active)
    least = told["negative"] + told["element_modes"]
    most = least + told["rounding"]
    if negative > most or negative + unsigned < least:
        raise Broken(
            "stability", f"told {least} negative eigenvalues, {most - least} unsigned; dense {negative}, {unsigned}"
        )


def when_finer(one: Attempt, seed: int) -> None:
    """Raises Broken where slender elements make a state unstable that is not when they are cut across."""
    n1, n2 = one.found.request.mesh
    if one.found.verdict != UNSTABLE or one.asked.refined or max(n1, n2) < SLENDER * min(n1, n2):
        return
    finer = f"{n1}x{2 * n2}" if n2 < n1 else f"{2 * n1}x{n2}"
    other = attempt(one.asked.with_options(mesh=finer), seed)
    if other.kind == CONVERGED and other.found.verdict != UNSTABLE:
        raise Broken("stability", f"unstable, but not on {finer}: {one.found.unstable[0]}")
