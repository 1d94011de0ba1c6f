"""How probable a name is by what it explains of time that no number was fitted to."""

from __future__ import annotations

from exo_sim.deciding_number import Number

_fitted = (
    "maximum likelihood, 85 names on learn makes A to D, I, K, L of whole machines (also healthy ones and what is outside the list) and on "
    "real machines: 77 were right, each with a share of 0.23 or more; of 8 that were wrong 6 had 0.11 or less"
)
EVEN_SHARE = Number(
    0.14, "share of what is missing without it", "a name that explains so much of held-out time is as likely wrong as right", _fitted
)
STEEPNESS = Number(3.4, "exponent", "with this power of that share the odds of a name rise", _fitted)
UNTESTED = Number(
    0.8, "probability", "no name is called more probable of which held-out time shows nothing", "of two on learn makes one was right"
)
MAY_BE_NIL = Number(
    0.8, "probability",
    "nothing is called more probable where all of its numbers may be nil: laws or other numbers that fit as well leave it nothing",
    "eight weighed names on learn makes (beside friction that varies with place or time, seals under pressure) and the vented MBARI "
    "spring: seven were right, (7 + 1)/(8 + 2)",
)  # fmt: skip
LEAST_ERRORS = Number(
    1.0, "standard errors", "a name weighed beside others whose number lies closer to nil, over all laws, is put aside",
    "asserted: its 68 % interval holds nil; seen on one healthy learn make (I, seed 711), where drag "
    "stood for a rig's own friction that bends otherwise: 0.26 standard errors",
)  # fmt: skip
LEAST_PROBABILITY = Number(
    0.5, "probability", "a name that is less probable is put aside: it is more likely wrong than right", "derived"
)
CALIBRATED = Number(
    0.85, "probability", "a nominal area, dead volume or mass that is called off is so",
    "16 of 18 on healthy machines of learn makes and of their laws came nearer to the truth: (16 + 1)/(18 + 2)",
)  # fmt: skip
