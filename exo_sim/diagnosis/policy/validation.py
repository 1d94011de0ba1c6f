"""What held-out time may refute, and what it adds."""

from __future__ import annotations

from exo_sim.deciding_number import Count, Number

HELD_OUT_SHARE = Number(
    0.3, "share of every recording", "no parameter is fitted to it",
    "recordings held out whole took the only high pressure (seals at 1 and 7 bar: friction that grows with it was lost)",
)  # fmt: skip
TEST_SHARE = Number(
    1.0 / 3.0, "share of the time held out",
    "nothing is chosen by it either, errors are reported from it; the rest is for validation, which decides what stands and needs more",
)  # fmt: skip
LEAST_DROP = Number(
    0.15, "share of what is missing, or of the validation error", "a finding that explains less of what is missing beyond the noise is "
    "refuted, or, where nothing is missing, one that lowers the error by less ...",
    "asserted; a learn machine's true lag of 7 ms, which lowers the error by 14 %, was refuted by the fall of the error alone",
)  # fmt: skip
LEAST_DROP_TOGETHER = Number(
    0.02, "share of the validation error", "... or by less than this where it was weighed beside all others at once ...",
    "learn make D of whole machines: a true Stribeck dip lowers the error by 11 %; the moving MBARI spring: what is not there by none",
)  # fmt: skip
REFUTABLE_ODDS = Number(
    25.0, "log10 of odds", "... unless its odds exceed these; nor is a name put aside then because its number may be anything",
    "asserted; X581's dip of friction has 95, at rest 25 N with an error of 29 N: without it windows are off by 34 times the noise; X645's "
    "lag 114, with an interval from nil. Two others that held-out time did not test and whose intervals held nil have 0 and 0.4",
)  # fmt: skip
BORNE_OUT = Number(
    0.9, "share of the squared error beyond the noise that is missing", "nor where it explains so much of held-out time",
    "X572's dry, viscous and Stribeck friction explain 0.998, 0.904 and 0.985, their numbers within 5 % of the truth, though beside a gas "
    "that has no name their errors exceed them; a false friction that grows with pressure (X581) explains 0.74. No machine without a part",
)  # fmt: skip
MOST_RISE = Number(
    0.1, "share of the validation error", "a finding that raises the error by more, not by chance, is refuted ...",
    "X554's hose raises it by 18 %, and has -0.6 of its change there with a standard error of 1.5: it is true, and a false regulator that "
    "was found with it spoilt both",
)  # fmt: skip
REFUTABLE_RISE_ODDS = Number(100.0, "log10 of odds", "... unless its odds exceed these")
CERTAIN_ODDS = Number(
    6.0, "log10 of odds", "a finding of forces, or one without which hardly more than noise is missing, stands at these odds whatever the "
    "error of held-out time does; what that time says of its change is counted in",
    "findings of 41 recordings of whole machines (X571 to X575, X600 to X619): true ones that were refuted have 10 to 54 (a dead band, a "
    "critical ratio, dips, viscous friction), false ones 0.4 and 5.0 (a drag, friction of two directions). Of a healthy one (X614) two "
    "names that explain a little of what its laws leave have 1.9 and -0.3",
)  # fmt: skip
LEAST_INFLUENCE = Number(
    0.3, "units of the noise", "a finding that changes predictions of the validation time by less was not tested there"
)
LEAST_MISSED = Number(
    1.0, "the most that noise leaves by itself", "a finding of forces without which the rows that it changes are missed by less is too "
    "small to matter",
    "derived: noise explains them. A false drag of a healthy learn machine (I) has 0.89, seven true names of B and I 3.5 and more",
)  # fmt: skip
BEYOND_HEALTHY = Number(
    2.0, "standard deviations of what laws of a healthy machine get wrong",
    "a finding of forces that changes its rows by more is not small, however little of it noise lets see at a time",
    "derived: nineteen in twenty healthy machines are off by less",
)  # fmt: skip
NEGLIGIBLE = Number(
    0.1, "standard deviations of what laws of a healthy machine get wrong",
    "a finding of forces that changes its rows by less is small whatever they are missed by: something else misses them",
    "a healthy whole machine (X1046) had friction of 8e-7 m2 by its pressures named, 0.01; eight true names of X1042, a stranger's W6 and "
    "S2 have 2.3 to 13. Of true names that had no part in it (X1052, strangers' W1 and W8) the least has 0.46, a dip",
)  # fmt: skip
FEWEST_CHANGED = Count(
    6, "rows", "what a finding changes in fewer is held against that as if it were spread over so many: one row of thousands is off by "
    "more than two standard deviations in any healthy machine",
    "asserted: a dip of friction may act in no more than the fewest onsets that count",
)  # fmt: skip
EXCEEDS_HEALTHY = Number(
    1.0, "standard deviations of what laws of a healthy machine get wrong",
    "... and one that changes them by more than this is not small where it exceeds what the fit leaves in fact",
    "learn machines: true dips change the rows of held-out time by 0.9 to 1.2 (B, X7, X11), and X7's those that were fitted, which count "
    "since, by 2.0; friction that slides by 3 to 16. The names of four healthy machines stay small",
)  # fmt: skip
FEWEST_SHARING = Number(
    1.2, "blocks of time that share a change", "fewer say nothing of how far it varies, nor do rows: what lasts for a block is in all",
    "derived: one block, and a second with a tenth of its change",
)  # fmt: skip
BLOCKS_TELL = Number(
    4.0, "blocks of time that share a change", "from so many on they say how far it varies; of fewer, rows do, each counted for as long as "
    "it is like the next, and the blocks only where they differ by more",
    "derived: Student's distribution of two degrees of freedom can take three decades at most, however surely a change is not there",
)  # fmt: skip
MOST_LIKE = Number(
    0.8, "correlation of neighbouring blocks", "is taken for so much at most: of few blocks it is known to 1/sqrt(blocks) only", "derived"
)  # fmt: skip
TOLD_APART = Number(
    2.0, "standard errors", "of the amplitude of what a finding changes in held-out time: where nil and all of it lie within, that time "
    "tells neither from the other, and a small share there says nothing", "derived: a 95 % interval",
)  # fmt: skip
SHOWN = Number(
    0.5, "share of the change that a finding makes",
    "a small share of all that is missing speaks against a finding where surely less of it is there, by one standard error",
    "derived: it is nearer to nothing than to what was found. Names of makes drawn at random that were put aside for shares below 0.15 "
    "were all true: four of X6, X522, X531 and X551 have 0.46 to 0.63 of their change, with standard errors of 0.08 to 0.67, a hose of "
    "X559 has 0.55 (0.21), a wall of X563 0.61 (0.16)",
)  # fmt: skip
NEEDED_BY_THE_MACHINE = Number(
    0.15, "share of the error of the whole machine over windows, in held-out time",
    "a finding that balances call too small to matter and that lowers it surely by more matters all the same: as much as a finding must "
    "explain of what is missing. That it is there is beyond doubt already",
    "learn make X12 of whole machines: with its dry friction of 67 N, which the balance of forces calls small, windows of a fresh "
    "recording are missed by 2.9 kPa, without it by 15.4 kPa",
)  # fmt: skip
CONTRADICTED = Number(
    2.0, "what a balance of forces leaves with it, in units of what it leaves without it, or of the noise",
    "above this a fault of a pressure's sensor that the gas asks for is refuted: forces hang on the pressure itself",
    "asserted; one machine set it at a stop whose runs are not kept, and none has shown it since",
)  # fmt: skip
LACKING_RATIO = Number(
    3.0, "validation error in units of what the fit leaves",
    "above this, and above what any healthy machine is missed by, the training time lacks something that acts later, and the other end "
    "of the recording is held out",
    "asserted. Within what healthy machines are missed by it cost whole machine X574 four of five names: its forces are missed by 3.6 "
    "times the noise, 0.7 in the fit, a healthy machine's by up to 5.8. Of ten real machines none has more than 1.2",
)  # fmt: skip
TEST_RATIO = Number(
    8.0, "test error in units of what the fit leaves", "above this something acts in the test time that was never found ..."
)
TEST_RATIO_BEYOND_BOUND = Number(
    4.0, "test error in units of what the fit leaves", "... and above this if it exceeds the discrepancy bound"
)
CLEARLY_BEYOND = Number(
    1.25, "test error in units of the discrepancy bound",
    "a fit within the bound is rejected if validation exceeds the bound and the test exceeds so many times the bound",
)  # fmt: skip
STRAYED = Number(
    3.0, "standard deviations", "a gas that is predicted in one run and misses the test time by more than a healthy machine has something "
    "unknown in it",
    "derived (probability 0.1 %); a healthy learn make (A, seed 930; B, C, D, I by an earlier form) and two printed cylinders stay below "
    "it; one of these with its leak left out, which windows of 0.5 s do not show, has five times what a healthy machine leaves",
)  # fmt: skip
HEALTHY_KNOWN = Number(
    1.0 / 3.0, "share, one standard deviation", "of what the errors and losses of a healthy machine add up to in one run: with the former, "
    "twice that is too much",
    "asserted: machines were asked for their limits, not for their sum",
)  # fmt: skip
SURELY_BETTER = Number(
    1.0, "standard errors", "by so much windows of the whole machine are better with an improved rig, or it is written only so far",
    "eight rigs of learn machines A and C and of a tank by a stranger on fresh recordings: two that pass have 0.81 of the error handed in, "
    "six that do not 0.90, 0.98, 1.05, 1.39, 1.51 and 1.58; chosen on these",
)  # fmt: skip
FAR_BETTER = Number(
    0.5, "share of the error", "windows of the whole machine need not be surely better where its free run misses no more than this",
    "a filmed swing without its friction: windows 0.96 with a standard error of 0.05, the free run 0.015",
)  # fmt: skip
FEWEST_BLOCKS = Count(
    4, "windows", "of the whole machine show how far errors of another recording may differ; of fewer the error itself counts"
)
STARTS = Count(
    4, "moments of held-out time", "at whose measured states the whole machine is run free as well, the first at its beginning",
    "49 signals of 18 diagnosed learn machines (X1 to X12, two J, X4 and X8 with a bore 22 % too small and 25 % too large): what one run "
    "from the recording's beginning says of the free run on a fresh recording is off by a factor of 3.1, four moments by 2.4, both by 2.3; "
    "of 18 positions, all better on the fresh one, the one run called three worse (1.14, 1.16, 1.32), the four moments none. Those runs "
    "went on to the end of the recording; that each now ends where the next begins was not measured",
)  # fmt: skip
STRAYS_BY_CHANCE = Number(
    0.05, "probability",
    "so few rigs that are equally good are said to stray, over all signals together, each of which has an equal part of it",
    "derived. Lognormal errors of four runs: 4 % of one signal, 5 % of six or thirteen; with the whole of it for each signal it was 25 % "
    "and 46 %, and with one standard error of five runs that all end together 39 % of one",
)  # fmt: skip
BETTER_BY_CHANCE = Number(
    0.05, "probability",
    "so few searches for what to write call a rig surely better from several states, over all signals together, that is equally good: half "
    "of it is for all that was found, with numbers of the balances and fitted together, the rest in equal parts for what is tried after. "
    "Then one run from the beginning that misses them by more does not speak against it, nor is that said of a signal",
    "derived. Lognormal errors of four runs: 3 % with twelve rigs; with the whole of it for each rig some rig passed in 35 % with eight",
)  # fmt: skip
FEWEST_STARTS = Count(3, "runs", "from different measured states say how far the errors of another such run may differ")
MOST_WORSE = Number(
    0.002, "share of the error",
    "the improved rig is written only as far as it is not worse than this, in windows or run free: rounding, no more",
)  # fmt: skip
SIGNAL_WORSE = Number(
    0.02, "share of the error", "where one signal of the improved rig is worse by more, it is asked whether it is better without a part"
)
WORTH_LEAVING_OUT = Number(
    0.02, "logarithm of the error, windows and free run together", "what is left out then lowers the errors by so much"
)
DIVERGED = Number(1e3, "logarithm of the error", "what a signal counts whose run with the update diverged: more than any other can gain")
NO_BETTER = Number(
    0.7, "share of the error of one free run", "an improved rig that leaves more is hardly better than the one handed in ...",
    "the bench of the README with a bore of 40 mm for 32 mm: 0.88 and 0.89 of two signals; with its true bore 0.003 to 0.013. Eleven cases "
    "of `same_answers`: 0.0 to 1.0, those above 0.7 at 6 to 25 times the noise",
)  # fmt: skip
STILL_FAR = Number(
    100.0, "units of the noise", "... and plainly off: then sizes that no fit moves are to be checked before what was found",
    "the same: with the wrong bore 102 to 4900 times",
)  # fmt: skip
