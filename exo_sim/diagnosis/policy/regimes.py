"""In which regime of a machine's motion or gas an error is said to lie."""

from __future__ import annotations

from exo_sim.deciding_number import Count, Number

STANDS_OUT = Number(1.3, "mean square error in the regime, in units of the whole's", "below this no regime is named")
MOST_OF_IT = Number(0.4, "share of the squared error", "so much of it lies in the regime that is named")
LEAST_TIME = Number(0.03, "share of the samples", "a regime that holds for less is not named ...")
FEWEST_IN_IT = Count(20, "samples", "... nor one of fewer")
LOUDEST = Number(0.3, "share of the 98th percentile of the mean square error", "a span of time is listed where the error exceeds this")
CLOSED = Number(0.01, "valve command", "a valve that is commanded less is closed")
SMALL_COMMAND = Number(0.05, "valve command", "commands below this are small: what a spool's overlap and dead-band concern")
AT_REST = Number(0.005, "m/s", "a piston slower than this is at rest, and one slower than ...")
AT_REST_SHARE = Number(0.05, "share of its fastest", "... this")
DRAWING = Number(0.2, "share of the largest flow", "the supply is drawn from above this")
FAST = Number(75.0, "percentile of speed", "a joint faster than this moves fast ...")
SLOW = Number(40.0, "percentile of speed", "... and one slower than this slowly")
BEFORE_REVERSAL = Number(0.02, "s", "a reversal begins so long before the change of sign ...")
AFTER_REVERSAL = Number(0.05, "s", "... and ends so long after it")
