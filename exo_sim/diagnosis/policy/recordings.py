"""What a recording must hold to be judged, and what is listed of it."""

from __future__ import annotations

from exo_sim.deciding_number import Count, Number

FEWEST_A_SECOND = Number(8.0, "samples a second", "fewer do not show what gas does, unless it does it slowly: a vessel that is closed ...")
SLOW_CHANGE = Number(
    0.1, "share of all that a pressure changes", "... where between two samples it changes by less: ten samples show a curve ..."
)
SLOW_NOISE = Number(
    6.0, "standard deviations of the pressure's noise", "... besides what noise does: the largest of a thousand differences is as large"
)
FEWEST_FOR_EVENTS = Number(25.0, "samples a second", "fewer do not show what a valve or a moving piston does to it")
QUIET = Number(3.0, "standard deviation in units of the noise", "a pressure that varies less says nothing")
CLEAR_FALL = Number(100.0, "fall in units of the noise", "a smaller fall of pressure does not show its onset")
HELD_OPEN = Number(
    0.1, "share of the time in which half of the fall is gone",
    "the supply was still open where the first hundredth of the fall took longer: a leak is fastest at first",
    "derived: an exponential fall needs 0.0145 of it; with seven times that the pressure was held",
)  # fmt: skip
FALL_BEGINS = Number(0.01, "share of the fall", "of which the time is compared with that of half the fall")
FALL_LEVEL = Count(
    5, "samples",
    "the first and the last level of a fall are read from; what was held for less than twice as many looks like the fall itself",
)  # fmt: skip
FEWEST_IN_COLUMN = Count(10, "finite samples", "a column that is left with no more, faulty ones blanked, counts as not recorded")
FEWEST_ROWS = Count(30, "rows", "a balance with fewer is not fitted")
FEWEST_ONSETS = Count(6, "onsets", "fewer starts from rest do not show by how much one differs from the next")
ONSET_REST = Number(
    3.5, "standard deviations of the filter", "an onset of motion has been at rest for so long: motion before it adds nothing to "
    "its peak",
    "derived: what lies further weighs 2e-4",
)  # fmt: skip
ONSET_MOTION = Number(
    5.0, "standard deviations of the filter", "... and moves on in one direction for so long: a jerk that a stop or an encoder "
    "makes is none",
)  # fmt: skip
FEWEST_OF_CHANNEL = Count(5, "finite samples", "a position or a slow channel with fewer is none")
FEWEST_OF_FALL = Count(20, "finite samples", "a pressure with fewer does not show how it fell")
FINE_PERIOD = Number(
    1e-3, "s",
    "a gas that was sampled faster is predicted at means of samples that are no longer: what is compared are means of 5 ms, and a valve's "
    "lag is some ms",
    "derived from these two; that it changes no name was not shown",
)  # fmt: skip
STEP_ERROR = Number(
    0.05, "share of the noise of a row",
    "where sensors sit behind hoses the steps of a fit's predictions are as long as they may be while what they are off by is no more "
    "than this: it adds a thousandth to what is left",
    "whole machine X856: half the processor time. With the same rule for all other steps X792 lost a critical ratio (3.6 times the noise) "
    "for a quarter of its time: those stay as they are",
)  # fmt: skip
LEAD_IN = Number(
    0.08, "s",
    "how a valve was commanded before a recording begins, nobody knows; its spool has forgotten it after a dead time and five lags of "
    "12 ms, the slowest of the learn makes",
    "make I of whole machines, seed 77, at its true numbers: eleven windows are predicted to within the noise, the first is off by 12 kPa. "
    "One machine: that it is long enough for a slower valve is not shown",
)  # fmt: skip
QUIET_START = Number(
    1.0, "s", "a recording whose pressures and piston rest for so long at first begins with gas that is as warm as its walls: some "
    "settling times of a small chamber at rest",
)  # fmt: skip
QUIET_DRIFT = Number(
    1e-3, "share of the pressure", "between the halves of that time a pressure that changes by less rests: gas of 1 K too much, which "
    "settles in 1 s, changes it by 1.5e-3",
)  # fmt: skip
WORTH_A_LEAD_IN = Number(10.0, "lead-ins", "a stretch that is shorter has no time to lose")
FEWEST_TO_FIT = Count(20, "samples", "a run with no more training time is not fitted")
STILL_LENGTH = Number(1e-4, "m", "a piston whose length varies by less does not move")
STILL_COMMAND = Number(1e-3, "valve command", "a valve whose command varies by less is not moved")
STILL_NOISE = Number(4.0, "standard deviations of the velocity's noise", "a rod or joint that is slower than this is at rest ...")
STILL_SHARE = Number(0.01, "standard deviation of its velocity", "... and one that is slower than this")
SAME_SIGNAL = Number(0.01, "share of what it varies", "a pressure that differs by less from the supply's is the supply's own")
VARIED_PRESSURE = Number(0.03, "share of the mean gauge pressure", "one that varies by less tells nothing of friction that it causes")
REVERSED = Number(
    0.1, "share of the squared error", "a valve command has the wrong sign where its opposite leaves less",
    "commands of 73 benches, legs and real machines turned round: `conventions` noticed 61, this one more, behind a long hose",
)  # fmt: skip
CONTROL_PERIOD = Number(
    2e-3, "s", "commands at no longer periods are all that a valve got; those of a slower logger may be samples of a quicker loop",
    "asserted: controllers of valves run at 500 Hz or faster, or are the loggers themselves",
)  # fmt: skip
CLOCK_ERROR = Number(0.01, "share of a period", "a logger's clock is off by no more: a longer period than that is longer")
HELD_AT_FIRST = Number(
    0.5, "share of the squared error", "commands are held until the next sample, as the contract has it, unless read as samples they leave "
    "less than this beside the nominal numbers of the rig ...",
    "six machines drawn by chance (200 and 400 Hz, held, three to eight effects missing): 0.76 to 1.59; the README's bench, thinned to 50 "
    "and 100 Hz, 0.30 and 0.77",
)  # fmt: skip
HELD_IN_THE_END = Number(
    0.8, "share of the squared error", "... or less than this beside all that a search has found under held ones",
    "held: three of those machines, 1.04, 1.13 and 1.19; samples: that bench, thinned to 250 Hz, 0.71",
)  # fmt: skip
BETWEEN_SAMPLES = Number(
    0.7, "share of what leaving out every other sample changes", "what is unknown between the samples, one standard deviation",
    "derived for a random walk: 3^-1/2. The README's bench with its true numbers, means of both chambers: 250 Hz 0.79, 100 Hz 0.88, "
    "50 Hz 0.37, noise and model within",
)  # fmt: skip
SAMPLING_SPAN = Number(
    1.0, "s", "over so long the square of that is averaged, about a window of a fit: a difference of two walks crosses zero",
    "whitened residuals of that bench at 50, 100 and 250 Hz with its true numbers: 1.40, 1.40, 1.46 over 0.2 s, 1.28, 1.16, 1.31 over 1 s",
)  # fmt: skip
COMPUTED = Number(
    3e-7, "share of its largest value", "a column that varies and has less noise was computed, not measured",
    "runs of this simulator, as Parquet: pressures 3e-8, positions 1e-9; real pressures from 4e-5 on; a real encoder (EMPS) has 8e-8, but "
    "its force 1e-3, so all that was measured must be as quiet",
)  # fmt: skip
SENSOR_SHOWS = Number(
    1e-4, "share of its largest value", "what a sensor shows in place of the noise that a computed column does not have",
    "asserted, one standard deviation: 12 bits over the range are 0.7e-4; the trials' sensors have 2e-4 (position) and 4e-4 (pressures)",
)  # fmt: skip
LISTED_SHARE = Number(0.02, "share of the squared error above the noise", "a balance with less is not listed as a place of the mismatch")
EXPLAINED_VARIANCE = Number(1.2, "residual variance in units of the noise", "what counts as explained in the end")
LISTED_REST = Number(0.01, "share of what there was to explain", "a smaller rest is not listed as unexplained")
LOUD_REST = Number(
    3.0, "units of the noise", "a rest that is larger is listed as unexplained, whatever share of the error it is and whatever was found"
)
LOUD_DRIFT = Number(
    20.0, "units of the noise", "a free run that is off by more, and what is left beside findings, is reported with the verdict"
)
LOUD = Number(3.0, "units of the noise", "a span of time is listed where the error exceeds this")
CORRECTED_PRESSURE = Number(50.0, "Pa", "a pressure whose sensor is off by less is not corrected for the balance of forces")
UNCERTAIN_PRESSURE = Number(20.0, "Pa", "what changes an imputed pressure by less is no uncertainty of it")
UNLOADED_NOISE = Number(4.0, "standard deviations of the force's noise", "a foot that pushes less than this is in the air ...")
UNLOADED_SHARE = Number(
    0.01, "greatest force", "... and one that pushes less than this: half a foot away it turns the joints above by a few N m at most"
)
GLANCING = Number(
    0.98, "component along the sole in units of the force",
    "a force within 11 degrees of the sole: a line that misses the contact by a millimetre meets the sole five times as far away",
    "a worn suit at toe-off, foot 55 degrees down on a sphere of 20 mm: up to 1.3 N m of 12 at the ankle, which passed for drag there",
)  # fmt: skip
LEAST_KNOWN = Number(0.5, "s", "a joint whose forces are all recorded for less than this is not judged")
SWITCHED = Number(
    0.1, "valve command",
    "a held command that changes by more within a step is followed in two parts, as a mean lies between two openings that were never "
    "there; over smaller changes the mean is",
    "asserted: two to four times the dead-bands of learn makes A and C (0.028, 0.049); it was not varied",
)  # fmt: skip
SWITCHED_OVER = Number(
    0.5, "valve command",
    "a valve whose command never changes by less is switched over, nothing else: whether it closes later than it opens is asked at once",
    "derived: half way from closed to open",
)
OFTEN_SWITCHED = Number(
    0.01, "share of samples",
    "a valve that is switched over at more of them keeps its run on the clock that it was recorded on: pulses are what it passes",
    "asserted: a square wave of 5 Hz at 2 kHz switches at 0.5 %",
)  # fmt: skip
NO_PART = Number(1e-3, "share of a step", "a part that is shorter is none")
FILTER_ENDS = Number(
    5.0, "standard deviations of the filter",
    "beside an end of a stretch the filter has nothing to take: over so long what it says is no motion",
    "a pendulum that is recorded from its swing on was missed there by 60 times the noise; the value itself is asserted: what lies further "
    "weighs 6e-7",
)  # fmt: skip
STEADY_SPEED = Number(
    0.5, "share of the speed", "within the filter's width a speed that changes by more is not compared: friction at a mean speed is no "
    "mean friction",
)  # fmt: skip
LEAST_COMPARED = Number(
    0.25, "share of the motion", "where less is compared, for the machine turns round too soon, a narrower filter is tried",
    "strangers' machines: a stamp of 0.9 kg with a spring has 0.10 and was not judged, a slide of 0.8 kg 0.13; a small cart has 0.43, a "
    "lift 0.76",
)  # fmt: skip
ROWS_ENOUGH = Count(
    60, "rows", "a filter as wide as noise asks for is not taken where it leaves fewer: twice what is fitted, for training time has part",
)
NOISY_FALL = Number(
    1.5, "power of the filter's width",
    "a change of the acceleration that falls at least so fast between the first widths is noise, white or not",
    "derived: white noise falls with its 2.5th power; the acceleration of a mass has the spectrum of a force, which does not rise with "
    "frequency, and falls with its 0.5th",
)  # fmt: skip
MOVES = Number(
    5.0, "standard deviations of the position's noise", "a joint whose position varies by less does not move",
    "asserted; a joint at rest shows 1, and the least of 27 that move, of trial cases and real machines, 263: between these any does",
)  # fmt: skip
FEWEST_A_KNOT = Number(5.0, "rows a knot", "fewer do not carry a curve of what is missing")
