"""The cells the pages ask for, by the labels of the campaign, and what is expected of them; nothing else."""

from __future__ import annotations

PAPER = "paper"
LINEAR = "linear"
BASE = "exact semismooth mixed exact"  # 42x40, dead load, travel of 20 mm in one step
SLOWEST = "exact trial-and-error plain exact"  # the paper's algorithm
REFERENCE = "{measure} semismooth mixed exact"  # what the other algorithms are compared with
ALGORITHMS = r"\S+ \S+ (mixed|plain) (exact|epsilon)"  # measure, contact, newton, enforcement
EPSILON = "exact semismooth mixed epsilon"
CONSISTENT = "consistent"
FINE = "fine"
FOLLOWER, FOLLOWER_FINE = "follower", "follower fine"
ISOTROPIC, ISOTROPIC_FINE = "isotropic", "isotropic fine"
SOLID, SOLID_PENALTY = "solid {mesh}", "solid penalty"
SOLID_MESHES = ("14x18", "28x36", "56x72")
ONE_STEP_MIXED, ONE_STEP_PLAIN = "hemisphere one step mixed", "hemisphere one step plain"
TWENTY_STEPS_PLAIN = "hemisphere twenty steps plain"
ELEMENT = "hemisphere {n} {interpolation} {thickness} {membrane}"
ELEMENT_MESHES = (8, 16, 32)

ONE_STEP = r"one step (?P<way>.+) \d+x\d+"  # inflation, then 20 mm at once
FAR = "far"  # as far as the path goes

EXPECTED_TO_FAIL = {
    ONE_STEP_PLAIN: "plain Newton cannot take the whole load in one step; the step has to be cut",
    "one step semismooth, settle 1 84x80": "the textbook's method chases sets far from the solution",
    FAR: "asked for more travel than there is",
}
DELTA = 20.0  # mm, the travel of the printed table
CURVES = (10.0, 15.0, DELTA)  # mm, travels of the cell PAPER that are drawn; without them there is no page
AGREEMENT = r"agreement .*"  # the tyre by all algorithms, loads and sections
AGREEMENT_REFERENCE = "agreement semismooth {load} {section} exact"
MODEL = r"model (?P<model>\S+) (?P<plies>.+)"  # the tyre as a whole and in parts
ELSEWHERE = (AGREEMENT, ONE_STEP, FAR, MODEL)  # tyres whose costs are on other pages than the tyre's
