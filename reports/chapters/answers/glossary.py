"""The part of words: what each means here, one meaning a word."""

from __future__ import annotations

from reports.markdown import Part, joined, listing, prose

INTRODUCTION = prose("""## Words

One meaning a word. Where everyday language has several, the pages use one name for each: *exact* is a strain measure
only (a reference is *of closed form*, contact without regularisation is the *exact condition*); *wrong* is what the
judge refuses, an answer far from its reference is *off*; a *model* is the part of a tyre that is solved, a shell theory
is a *strain measure*; *contact set* is a set of nodes, *contact algorithm* a way to find it; *cost* is processor time
or operations, whichever stands beside it.""")
WORDS = {
    "What is solved": {
        "scene": "a problem: geometry, material, supports, load, and the quantities that are measured",
        "cell": "one request of a campaign: a scene with every setting given, solved once",
        "problem": "all that a cell asks for but the competitor: put to several algorithms, or several measures",
        "campaign": "a list of cells, solved into one store",
        "model": "the part of a tyre that is solved: full, half, mirror, quarter, or one column of elements",
        "travel": "of the plane, counted from first touch of the inflated tyre; in tables Δ or `delta_mm`",
        "load fraction": "load over the load that the scene names",
        "quantity": "a number of an answer, with its unit in its name",
        "headline": "the one quantity of a scene that configurations are compared by",
    },
    "Shells": {
        "strain measure": "the formulas that make strains of displacement gradients; `exact` keeps all terms of the "
        "Green-Lagrange strain of a shell whose normals stay straight",
        "classical measure": "any other one: terms are dropped, as `linear`, `von-karman`, `donnell`, `sanders` do",
        "section": "how the wall's law becomes stiffness: `constant-s33`, `nonsymmetric`, `full-3d`",
        "element": "`refined`, the default: curvilinear, balanced, relaxed; `paper`: as in the paper",
        "plain, mixed": "Newton iterations: mixed ones keep stresses as unknowns, and take fewer and longer steps",
        "dead, follower": "a pressure that keeps its direction and area, or turns and grows with the wall",
        "limit point": "the largest load of a path, where the tangent is singular",
        "path ends": "the equilibrium path itself stops or turns before the load that was asked for",
        "unstable": "an equilibrium with negative eigenvalues of the tangent, found all the same",
    },
    "Contact": {
        "contact set": "the nodes that touch; patch: the same as an area",
        "exact condition": "no gap and pressure, no penetration: ε infinite",
        "ε": "regularisation: pressure over penetration, MPa/mm",
        "settle": "fraction of the contact set that may change before the next linearisation; 1: each set gets one",
        "set change": "a Newton iteration after which a node has entered or left the contact set",
        "judge": "recomputes equilibrium, penetration, tension and complementarity of an answer; trusts no algorithm",
        "refused": "an algorithm says why it does not apply; no failure",
        "cap-hit": "a limit of iterations was reached",
        "wrong": "called converged and refused by the judge",
        "failed": "neither solved nor refused, and its path goes on",
        "solved share": "solved over solved and failed: of problems that could be solved",
        "obstacle": "the rigid body that is touched",
    },
    "Friction": {
        "Coulomb friction": "along the foundation a node carries at most μ times what it carries across it",
        "stick": "no way over the foundation since the load step began; the node carries less than the friction bound",
        "slip": "a way over the foundation, in mm; the node carries the friction bound, against its way",
        "anchor": "where on the foundation a node was when the load step began, which its slip is counted from",
        "friction bound": "μ times the normal force",
        "naive set": "states open, stick and slip that are swapped after equilibrium: `trial-and-error` with friction",
        "return mapping": "a spring's force beyond the bound is put back on it, along itself: radial return",
        "dissipation": "work of friction on slips, never negative",
        "load steps": "with friction part of the answer, which changes with their size to first order",
        "capstan": "a strip that slips on a drum by an angle θ: its ends pull as 1 to exp(μ θ)",
        "parking torque": "of friction about the normal, when the foundation is turned on the spot",
    },
    "Accuracy": {
        "error": "relative, of a quantity, against its reference",
        "reference": "closed form, computed, read from a figure or printed; with its uncertainty",
        "limit": "of a sequence of meshes, extrapolated by Richardson",
        "asymptotic": "monotone, with two successive orders that agree",
        "order": "p of an error that falls as the size of the elements to the p",
        "mesh part, model part": "error of a mesh against its limit; of the limit against the reference",
        "bound": "the verified error and what its reference is uncertain by",
        "verified": "held against a reference, or the limit of its ladder",
        "ladder": "one request on three meshes or more",
        "regime": "scenes whose shells move alike",
    },
    "Cost": {
        "seconds": "processor time of a solve, others beside it; the median of the timing lane where it was timed",
        "operations": "floating-point operations of assembly, factorisations, solutions, pivots and iterations, all of "
        "them; the same on every machine",
        "unknowns": "of the linear systems: degrees of freedom and multipliers",
        "profile": "the share of problems that are solved within a factor of the cheapest",
        "both": "problems that both of two solve, on which alone their costs are compared",
        "regret": "cost of the advice over that of the cheapest cell that meets the tolerance",
        "configuration": "measure, algorithm, Newton iteration, element, mesh and tolerance",
        "timing lane": "cells solved again and again, alone on the machine",
    },
    "Findings": {
        "finding": "a sentence of conclusion, made of tables, with what it rests on",
        "contender": "an algorithm, or a solver alone, in the test of claims",
        "claimed": "called solved by who has solved it",
        "false": "claimed, and refused by the judge",
        "law": "what two answers to one question must keep, as symmetry or other units",
        "planted fault": "a wrong term put into the code to see whether a test finds it",
    },
}


def words_part() -> Part:
    """The whole part, the same for every campaign."""
    rows = [{"word": word, "meaning": meaning} for words in WORDS.values() for word, meaning in words.items()]
    return joined(INTRODUCTION, listing("Words", rows, "word | meaning", "{word} | {meaning}", words=2))
