"""When a believed number is off."""

from __future__ import annotations

from exo_sim.diagnosis.policy.number import Number

SURE = Number(3.0, "standard errors, or prior standard deviations", "a number so far from what was believed is off (probability 0.3 %)")
MODEL_SHARE = Number(
    0.0015, "share, one standard deviation", "no equation describes a machine, nor a sensor its pressure, to better than this"
)
BEYOND_DOUBT = Number(
    5.0, "standard errors", "what differs by more from what was believed is listed although it is too small to matter"
)
WORTH = {
    "flow_capacity": Number(0.01, "share", "a valve's area is corrected from here on"),
    "dead_volume": Number(0.03, "share", "a dead volume is corrected from here on"),
    "payload_mass": Number(0.005, "share", "a mass is corrected from here on"),
    "joint_damping": Number(0.15, "share", "a joint's damping is corrected from here on"),
}
WORTH_OF_EFFECT = Number(0.1, "share", "the same for a parameter of an effect that the rig has on already")
WORTH_WHERE_LAW_IS_OPEN = Number(
    0.3, "share", "and for one of an effect whose law the rig leaves open: laws that fit as well give it other values",
    "healthy learn makes A, B, D and I: breakaway and velocity of the dip that the rig knew within 5 % came out 10 to 19 % away",
)  # fmt: skip
MOVED = Number(1e-3, "share", "a parameter that a fit moved by less did not move")
LEAST_PART = Number(0.05, "share of an additive effect", "a smaller part of it is not written into the improved rig")
