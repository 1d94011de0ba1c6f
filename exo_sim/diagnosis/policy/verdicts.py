"""What stands as a finding, what is unknown, and what looks alike."""

from __future__ import annotations

from exo_sim.deciding_number import Number
from exo_sim.diagnosis.policy import acceptance

AS_GOOD = Number(
    3.0, "log-likelihood, parameters paid for",
    "a rival that is worse by less explains the recording as well: a Bayes factor of 20, the usual bound of strong evidence",
    "derived from the scale of Kass and Raftery (1995)",
)  # fmt: skip
MOST_CONFIDENT = Number(
    0.95, "probability", "no finding is called more probable, however great its odds: laws that nobody has thought of are in none of them",
    "names that were right on whole machines of an independent truth: 56 of 60",
)  # fmt: skip
CONFIDENT_BESIDE_UNKNOWN = Number(
    0.8, "probability",
    "nor one more probable than this that stands in a gas beside something without a name, or in forces made of its pressures: it may be "
    "the name of a part of that",
    "a sealed bench whose hose, cushion and late valve had no name together: friction that depends on pressure was certain",
)  # fmt: skip
SWINGS_OFF = Number(
    0.2, "share of the standard deviation of the motion",
    "what nothing drives and is further off in one run from its first state is not consistent with its rig, whatever its forces show ...",
    "a pendulum of 1.475 m for 1.45 m, filmed at 30 frames a second with 1 mrad of noise: 0.96, its balance of forces within the noise",
)  # fmt: skip
FIRST_STATE = Number(
    4.0, "standard deviations", "... and further than the noise of the position in its first rate explains",
    "the same pendulum with its true rig: 0.22 of the motion, by its first rate alone",
)  # fmt: skip
PROBABLE = Number(
    0.75, "probability", "an effect of the most probable subset is named from here on, alone or as one of those that exclude each other"
)
DECISIVE = Number(
    1.0 / (1.0 + 10.0**-acceptance.LEAST_ODDS), "probability",
    "the same beside something without a name, of which a name that is merely probable may be a part: decisive odds",
    "derived from the odds of acceptance; the vented MBARI spring, whose friction varies with place, had a return spring at odds of 6",
)  # fmt: skip
LEAST_UNNAMED = Number(
    0.08, "share of all friction", "friction that varies with place or time by less, root mean square, is what many machines show",
    "learn makes of whole machines, a version of this fit before the last: 27 without such friction showed none; with it, 0.1 to 0.3",
)
ALIKE = Number(0.1, "share", "numbers of a richer form that differ by less are one number: friction of two directions, of any seal")
EXPLAINED = Number(0.90, "share of the explainable squared error", "names stand if they explain so much, although something is left")
HALFWAY = Number(0.8, "share of the explainable squared error", "between this and the former they stand if what is left has no pattern")
PATTERN = Number(0.25, "share of variance in cross-validation", "one signal that predicts more of what is left is a pattern")
LARGER_PART = Number(
    0.7, "share of what is missing without it", "where something is left in a gas, each finding explains so much: no two valves are alike"
)
PLAINLY_MORE = Number(
    3.0, "discrepancy bounds", "a balance of forces that is missed by more has something unknown in it, whether it follows a signal or not"
)
UNKNOWN_VARIANCE = Number(
    5.0, "residual variance in units of the noise", "without any finding more than this is unknown if it is correlated"
)
UNKNOWN_WHITE = Number(15.0, "residual variance in units of the noise", "and more than this always")
UNKNOWN_CORRELATION = Number(2.0, "rows of correlation", "residuals are correlated above this; white ones are a noisy sensor's")
HOPELESS_GAS = Number(
    2.0, "root mean square residual in units of the discrepancy bound",
    "a gas with more left has something unknown in it, whatever share was explained",
)  # fmt: skip
PLAIN_ODDS = Number(
    30.0, "log10 of odds", "above these a finding need not surely exceed a healthy machine's: only nuisance parameters that "
    "could stand in for it make it vague",
)  # fmt: skip
STRAINED = Number(
    3.5, "prior standard deviations", "a nuisance parameter that is further from its mean speaks for something missing",
    "derived from a two-sided error of 0.05 %: a machine has a dozen of them",
)  # fmt: skip
NOZZLE_LOW = Number(
    0.508, "critical pressure ratio",
    "from here on the ISO ellipse stands for the paper's nozzle (0.528): nothing chokes at a greater ratio, and a fit that wants one mends "
    "something else, a supply that reads too little",
    "derived: the laws differ by 1.4 % of choked flow at most there, by 0.15 % at 0.5283. A nozzle whose supply read 0.6 % too little "
    "had a ratio of 0.559 with odds of 95",
)  # fmt: skip
AT_BOUND = Number(0.01, "share of the value", "a number that ended so near to a bound was not found: something else acts")
LEAST_CURVE = Number(0.2, "share of variance in cross-validation", "a curve that predicts less does not describe an unknown effect")
PLAINLY_LESS_DAMPING = Number(
    20.0, "log-likelihood", "damping whose nominal value is too large takes the place of what was found where less of it gains so much"
)
LEAST_DAMPED = Number(0.9, "share of the nominal damping", "damping is free from the start where no more of it is left by a fit ...")
LEAST_LEFT = Number(0.8, "share of the squared error", "... and this much of the error: free damping hides viscous friction else")
NIL = Number(1e-3, "share of its usual size", "an effect of which a fit left less is none")
OBVIOUS_FAULT = Number(10.0, "log10 of odds", "of a sensor's fault that its column shows by itself, without any model")
GAUGE_ERROR = Number(2000.0, "Pa", "how far the air pressure of the day is from the rig's: half the interval of a gauge sensor's bias")
LATE_ERROR = Number(3e-3, "s", "half the interval of how late a command is: a healthy valve and card may be late themselves", "asserted")
FAR_WORSE = Number(7.0, "log-likelihood", "below the chosen effect, odds of a thousand to one: a rival is said to fit far worse")
NOTHING_EXPLAINED = Number(0.01, "share of what is left", "a rejected candidate that explains less is said to explain nothing")
HALF_EXPLAINED = Number(
    0.5, "share of what is left", "of a rejected candidate that explains less the share is stated; of one that explains more, that it does "
    "not do so in all blocks of time", "asserted; it chooses between two sentences, and no finding hangs on it",
)  # fmt: skip
LOST = Number(
    4.0, "times the squared error that a subset left when it was weighed, or of the noise",
    "a fit that leaves more lost its way, and those of other subsets are tried",
    "make X522, seed 3: 0.75 a row where it was weighed, 18 where it was fitted, 0.5 fitted with one level for both directions",
)  # fmt: skip
SHAPE_NEEDED = Number(
    5.0, "log-evidence",
    "a law has one number more (the power of a film, the tail of a dip, the damping of bristles) where it is better by more; else it "
    "stays plain, and what the other would say widens its intervals",
    "derived from the scale of Kass and Raftery (1995): very strong evidence, for contacts that creep as no law here does look like a "
    "film that thins",
)  # fmt: skip
SET_BY_LAWS = Number(
    3.0, "times the half width of the interval that the fit alone has",
    "an end of an interval that is further off is said to be that of other laws: it is no number of the law that is named",
    "asserted; it chooses whether a sentence is said, and no finding hangs on it",
)  # fmt: skip
LEAST_LAW_WEIGHT = Number(
    1e-4, "probability in units of the most probable law's", "a law that is less probable does not widen an interval"
)
