"""When a candidate is accepted into a model, and when a search goes on."""

from __future__ import annotations

import math

from exo_sim.deciding_number import Count, Number

LEAST_ODDS = Number(
    2.0, "log10 of odds",
    "a candidate is accepted above these odds, decisive on the scale of Jeffreys (1961), after the price of its parameters and of the "
    "number of candidates",
)  # fmt: skip
SURELY_MORE = Number(
    math.sqrt(2.0 * math.log(10.0) * LEAST_ODDS), "standard errors",
    "by so many a number exceeds what a healthy machine shows: the likelihood ratio of both is then that of the former",
    "derived; a healthy bench that lacks a pressure (two traces of the valve and a slow spool stand for one hysteresis) has 2.1",
)  # fmt: skip
LEAST_SHARE = Number(
    0.10, "share of the explainable squared error",
    "a candidate explains at least so much of what is missing: no correction for correlation stops an effect that mends the shape of "
    "another's law a little",
)  # fmt: skip
MOSTLY_EXPLAINED = Number(
    0.9, "share of the explainable squared error",
    "above this the rest of a real machine has no particular shape, and every candidate fits a little of it",
)  # fmt: skip
SHARE_OF_THE_REST = Number(
    0.5, "share of the explainable squared error", "what a candidate then explains of the rest, unless it reaches the noise"
)
BESIDE_DISCREPANCY = Number(
    20.0, "log10 of odds",
    "beside a process that stands for noise and for what the model still misses, an effect counts from here on, however small its share",
    "learn makes A and D of whole machines",
)  # fmt: skip
RELIEF = Number(
    9.0, "fall of -2 log of the prior of all nuisance parameters",
    "an effect with a shape of its own counts however little it lowers the error, where without it the numbers of the rig are so much "
    "further from their data sheets: they hide what it does as long as the recording is like this one",
    "derived: three standard deviations of one number. The critical ratios of whole machines X630 and X634 lower the error by 3 and 8 %, "
    "and the prior by 17.4 and 11.9: a set pressure that was 8 % off (3.9 standard deviations) did the rest. Named, windows of X630's rig "
    "miss by 0.56 of one with the true names (0.98), its free run by 3.6 (3.8); X634's by 0.75 and 1.25 (0.71, 1.08). Of 47 searches (X570 "
    "to X575, X605 to X634) three false effects relieve the numbers by more (11.5, 70, 75), none with a steady shape of its own",
)  # fmt: skip
CLEAN = Number(
    1.8, "residual variance in units of the noise",
    "below this nothing is left to explain",
)  # fmt: skip
NEEDED = Number(
    2.0, "fall of -2 log of the posterior, a parameter",
    "what gains less of an imperfection that healthy machines have is left at zero in the model that is accepted",
    "derived: Akaike (1974), a parameter that gains less than one unit of log-likelihood predicts worse than its nominal value",
)  # fmt: skip
STEADY_GAIN = Number(
    2.0, "mean gain over blocks in units of its standard error", "a gain that one block alone brings is no effect",
    "a bench with a relief valve, which is outside the list: this alone removed an effect that had stood, of 0.4 with odds of 49 beside "
    "the discrepancy; of 94 others on 22 benches, legs and real machines it decided none",
)  # fmt: skip
STEADY_SHARE = Number(
    0.2, "share of the explainable squared error", "above this a candidate need not gain in every block",
    "a printed cylinder's pressure decay gains in its first block (1.02), a hose in a few (1.9), a leak of a walking leg (1.8): with 0.8 "
    "to 1.0 of the error explained all three are true",
)  # fmt: skip
BEYOND_DOUBT_ODDS = Number(
    50.0, "log10 of odds",
    "beyond doubt a candidate counts although it lowers the error by less than is practically significant: above this ...",
)  # fmt: skip
BEYOND_DOUBT_SHARE = Number(0.5, "share of the explainable squared error", "... with the larger share of the error ...")
BEYOND_DOUBT_VARIANCE = Number(
    1.2, "residual variance in units of the noise", "... of an error that is above the noise at all, or with a shape of its own",
    "a leak of a stranger's S1, 1.6e-8 m2 beside wall heat, lowers the error from 1.045 to 0.998 of the noise with odds of 97: four edges "
    "of a healthy valve hide the rest. Named so; the variance alone kept it out",
)  # fmt: skip
UNDERRATED = Number(
    10.0, "ratio of drops in squared error",
    "a candidate is not fitted if so many times what its linear signature promises could not be accepted",
    "68 accepted candidates in 15 opened cases: a fit gained at most 2.8 times what was promised",
)  # fmt: skip
STAYS_WHITE = Number(
    0.7, "share of the white noise between neighbouring rows",
    "so much of it at least is left by every candidate; what it could then explain is too small to matter in a healthy gas, and none is "
    "asked. Not all of it, for the noise is a median over the rows of both chambers",
    "four healthy gases of learn makes A and K, seed 77: the noise is 0.77 to 0.82 of a row's, what is left 0.79 to 1.01, and 0.4 to 0.5 "
    "less would matter",
)  # fmt: skip
NEARLY_AS_MUCH = Number(
    0.93, "share of what another model explains",
    "a simpler model that explains so much takes its place: one with fewer parameters than the best of those that a search grows from, and "
    "what stands of a model that was found by asking all candidates together",
)  # fmt: skip
AS_MUCH = Number(0.999, "share of what the richer model explains", "a simpler form that explains so much is as good")
NO_WORSE = Number(
    12.0, "log-likelihood",
    "a simpler form whose log-likelihood is lower by less is as good",
)  # fmt: skip
SWAP_GAIN = Number(2.0, "log-likelihood", "a swap raises the log-likelihood by so much, and by as much again for each parameter more")
FAR_FROM_RIVALLING = Number(
    1.5, "ratio of squared errors",
    "a set that leaves so many times what the best does after its first look is not fitted to the end: its last steps gain little",
)  # fmt: skip
CERTAIN = Number(
    2.5, "standard errors", "a finding has a parameter that is so far from neutral ...", "derived from a two-sided error of 1.2 %"
)
VAGUE_LOSS = Number(
    30.0, "log-likelihood",
    "... or the model without it is worse by so much: its parameter is then vague only because nuisance parameters stand in for it",
)  # fmt: skip
HOPELESS_SEARCH = Number(
    15.0, "root mean square residual in units of the discrepancy bound", "above this each further effect must halve the error, or the "
    "search ends: no name helps another machine's recording",
)  # fmt: skip
STIFF_PRIORS = Number(
    3.0, "rows of correlation", "above this the weight of the priors may hold nuisance parameters back: the fit is repeated without it"
)
LEFT_WHEN_FREE = Number(
    0.01, "share of what was missing", "the repeated fit counts if it leaves no more: then it was a nuisance parameter that was off",
    "a weight of 35 % too much that alone makes an unchanging error is found so (tests of the search); of 214 repeated fits in 80 benches, "
    "legs and real machines and three whole machines none left so little",
)  # fmt: skip
LONGEST_CORRELATION = Number(60.0, "rows", "the largest weight of the priors")
UNCORRELATED = Number(
    0.05, "autocorrelation",
    "the integrated autocorrelation time, by which evidence is divided, ends where it is smaller: what is beyond is noise of the estimate "
    "(Geyer 1992)",
)  # fmt: skip
FEWEST_PAIRS = Count(20, "pairs of rows", "fewer do not tell an autocorrelation")
