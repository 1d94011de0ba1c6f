"""How much is tried: what lies beyond is neither fitted nor found."""

from __future__ import annotations

from exo_sim.deciding_number import Count, Number

# -- one search -----------------------------------------------------------------------------------------------------------------
MOST_FINDINGS = Count(5, "findings", "of one search that adds effects one after the other: a sixth would be fitted to what five leave")
BEAM = Count(
    2, "sets", "are grown side by side while none reaches the noise: the right pair need not hold the best single effect; what this does "
    "not meet is proposed together"
)
MOST_SWAPS = Count(2, "swaps", "a rival may so often take a finding's place in the end")
MOST_FURTHER = Count(2, "times", "further forms of what was found are asked: of what shows beside the first ones, once more")
MOST_JOINT = Count(3, "rounds", "of asking for all effects together, where the first does not reach the noise")
WORTH_A_ROUND = Number(0.1, "share of the squared error", "each of those rounds lowers it by so much, or is the last")
STRAY = Number(
    10.0, "squared error before any fit, in units of the model's", "effects are left out of a joint proposal until it is below this: "
    "a fit that begins further away does not arrive",
)  # fmt: skip
REDUCED = Number(
    0.25, "share of the size", "of a new effect where a fit that begins with the whole is that far off, again and again ...",
    "X712 of whole machines, seed 17: with its usual ratio the flow law left 72 times as much, and its fit ended at 43 times; begun at a "
    "quarter or less it ends at 0.66",
)  # fmt: skip
MOST_REDUCED = Count(4, "times", "... but no more often: a 256th of a usual size shows nothing", "convention, not measured")
MOST_EXTENSIONS = Count(3, "effects", "are added one by one to those that were proposed together")
MOST_FITTED = Count(
    80_000, "samples of a gas",
    "are predicted in a fit, 80 s at 1 kHz: of longer recordings blocks that are spread over all of them",
    "half an hour at 1 kHz with a warm wall: a prediction of 120,000 took 0.13 s, and a search made 1,045",
)
WORTH_CUTTING = Number(
    1.25, "samples, in units of what is fitted",
    "of recordings that hold hardly more nothing is cut out: blocks lie seconds apart, or are none",
)  # fmt: skip
LONGEST_FITTED = Number(
    120.0, "s", "of a balance of forces are fitted, of longer recordings blocks that are spread over all of them",
    "of ten minutes friction of 4 N, known to 20 N, was named in a healthy balance: a model's own error does not average out",
)
BLOCKS = Count(8, "blocks", "of a long recording stand for it")
LEAD = Number(
    3.0, "s", "are predicted where a block begins, and before the test time of a long recording, for its gas to come to its temperature",
    "half an hour at 1 kHz: with the first seconds the blocks were missed by 860 Pa, the held-out time by 380 to 440 Pa",
)  # fmt: skip
MOST_EFFORT = Count(
    80_000_000, "predicted samples",
    "after which the searches of a cylinder's gas seek nothing more, about a minute of a processor: the same on every machine",
    "learn makes A, B and D of whole machines were through before 60 million; 0.65 to 0.75 microseconds a sample at 1 kHz; what a "
    "prediction costs beside its samples counts",
)
LEAST_LATER = Number(
    0.25, "share of that",
    "every search after the first may take at least, in a later round or under commands read as samples: it may begin from nothing",
    "asserted; it does not cover asking all candidates together. Learn make X5 of whole machines, seed 1: its third search, in the other "
    "division of time, names the same two effects with 10, 20, 33 and 80 million, and is through after 74",
)
MOST_STEPS = Count(12, "Gauss-Newton steps", "of a fit")
FIRST_LOOK = Count(8, "Gauss-Newton steps", "of a first look at a set that is most likely far off, with the derivatives of its neighbour")
FELT_TOLERANCE = Number(
    0.01, "share of the squared error",
    "each step of the fit that asks whether a gas is as warm as the room lowers it by so much, or is the last: nothing else is taken of it",
    "14 cases of `same_answers`, one of each kind, and two benches answer byte for byte as with a tolerance of least squares' own",
)  # fmt: skip
WORTH_A_LOOK = Number(0.1, "share of the squared error", "each of these steps lowers it by so much, or is the last")
FIRST_LOOKED = Count(2, "sets", "of those that were looked at are fitted to the end, where only the best is wanted")
LARGE = Count(4, "candidates", "from here on what is fitted beside a model is fitted once, and only where it promises something")
FINALISTS = Count(4, "candidates", "of the largest score are fitted in one step of a search")
FORMS_OF_ONE = Count(2, "forms", "of one effect among them")
CHEAP_STARTS = Count(3, "starts", "of one candidate's fit, where predictions cost little")
LAW_STARTS = Count(
    3, "starts", "of a law that a rig leaves open, from each of which the first steps are taken",
    "all that are declared; a healthy machine of learn make Q whose hose is 1.7 m: from the best start alone, 0.5 m, the fit never left it",
)  # fmt: skip
FEW_SAMPLES = Count(2000, "samples", "predictions of fewer cost little: every candidate is then fitted, whatever its score")
ADAPTED = Count(2, "times", "the error process is estimated anew from what the best subset leaves")
MOST_BEGUN_FROM_NESTED = Count(
    3, "fits", "of one model from models with an effect less that are more likely than it: each is the more likely of two",
    "asserted; the friction of X572, which its fit left 22 times the noise of, and without its Coulomb part 3.7",
)  # fmt: skip
RUNNERS_UP = Count(3, "candidates", "that were put aside are looked at once more, and listed")

# -- a linear family ------------------------------------------------------------------------------------------------------------
FAMILY_FINALISTS = Count(25, "subsets", "that a climb meets are weighed with spreads of their own")
MOST_REFITTED = Count(
    4, "subsets", "are fitted as they act where what the most probable ones share leaves more than any healthy machine does",
    "learn make D of whole machines, seed 1411: the third leaves 1.5 times the noise, what all share 21 times",
)
MOST_CLIMBS = Count(4, "climbs", "each with the spreads of the best subset before it")

# -- the numbers of the improved rig, fitted to the whole machine ---------------------------------------------------------------------
_rigs = (
    "X630, X635, X644, X645 of whole machines, numbers fitted to all of their recordings: errors on fresh ones, over those of rigs with "
    "the true names, windows of 0.5 s and run free. Before 0.56 and 3.6, 1.16 and 3.9, 3.0 and 2.6, 0.56 and 3.3"
)
MACHINE_WINDOW = Number(
    2.0, "s", "after so long a run that numbers are fitted to takes over the measured state: short ones hide what a piston integrates, one "
    "run without end is at the mercy of where it first stuck",
    f"{_rigs}; after one step with windows of 0.5 s 0.34 and 1.1, 0.49 and 0.23, 0.93 and 0.91, 0.51 and 3.9; of 1 s 0.33 and 0.88, 0.50 "
    "and 0.26, 0.88 and 1.1, 0.45 and 1.9; of 2 s 0.35 and 0.37, 0.49 and 0.37, 0.86 and 1.0, 0.44 and 0.81; without end 0.37 and 0.73, "
    "0.70 and 0.52, 0.93 and 0.86, 0.43 and 0.32. After four steps of 2 s: free runs 0.19, 0.56, 1.2, 0.73, windows no better",
)  # fmt: skip
MACHINE_ROW = Number(0.01, "s", "between two samples that count: pressures and positions of a machine hardly differ from one to the next")
LONGEST_MACHINE_FIT = Number(60.0, "s", "of training time are run for it, leads among them; of more blocks that are spread over all of it")
MACHINE_BLOCK = Number(4.0, "s", "each of these blocks counts, behind its lead: two windows")
MACHINE_DIFFERENCE = Number(0.3, "standard errors", "by which each number is moved for its derivative: a run that sticks is not smooth")
MACHINE_WEIGHINGS = Count(10, "times", "the errors of the runs are weighed anew by what the step before leaves of them, at most")

# -- a time that was given -----------------------------------------------------------------------------------------------------
_machine_a = (
    "of the 36 s of learn machine A the gas took 50 %, the forces 26 %, validation 7 %, the improved rig 7 %; "
    "no other machine was asked"
)
GAS_UNTIL = Number(0.55, "share of the time", "the gas of all cylinders may take, in equal parts", _machine_a)
FORCES_UNTIL = Number(0.75, "share of the time", "is over when the balances of forces end, in equal parts", _machine_a)
VALIDATION_UNTIL = Number(0.85, "share of the time", "is over when what was found is refitted no more for held-out time", _machine_a)

# -- a diagnosis ----------------------------------------------------------------------------------------------------------------
MOST_REFUTATIONS = Count(6, "times", "effects are refuted on one division of time")
MOST_ROUNDS = Count(
    2 * MOST_REFUTATIONS * 2, "rounds", "two divisions of time, so many refutations each, with and without the friction of pistons"
)
LONGEST_FREE_RUN = Number(
    600.0, "s", "recordings that are longer together are not simulated once more: `compare` does it where it is asked to"
)
MOST_IN_ONE_RUN = Count(
    600_000, "samples of a gas", "are predicted in one run, ten minutes at 1 kHz: of longer recordings what leads to the test time",
    "0.65 to 0.75 microseconds a sample: half a second for each number that was fitted",
)
MOST_REJECTED = Count(20, "candidates", "that were rejected are listed at most")
MOST_SPANS = Count(6, "spans of time", "are listed of one balance at most")
AS_TELLING = Number(
    0.05, "share of the expected odds (log10)",
    "of experiments that differ by less only the first of the menu is listed, which is the easiest: a friction that no pressure changes "
    "shows as well at any",
    "convention, not measured: one motion at three pressures had odds that were equal to ten digits",
)  # fmt: skip
RANKED = Count(3, "experiments", "that would separate two explanations are listed")
MOST_TRIALS = Count(
    12, "improved rigs",
    "are run over a held-out time, then no more of what was found is left out; what was begun is ended, and what was found is run alone",
)
