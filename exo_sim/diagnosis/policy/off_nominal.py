"""When a nominal number is off."""

from __future__ import annotations

from exo_sim.deciding_number import Count, Number
from exo_sim.diagnosis import nominal_numbers

SURE = Number(
    3.0, "standard errors, or prior standard deviations", "a number so far from its nominal value is off",
    "derived from a two-sided error of 0.3 %",
)  # fmt: skip
MODEL_SHARE = Number(
    0.0015, "share, one standard deviation", "no equation describes a machine, nor a sensor its pressure, to better than this"
)
GAIN_SHARE = Number(
    0.003, "share, one standard deviation",
    "a number is known no better than the gain of the sensors that it was measured through, which no data sheet promises to better than "
    "0.25 to 1 %: forces, and all that acts on them, are off as the pressures are",
    "derived from a class of 0.5 %. Nine masses and viscosities on machines of two draws with gains within 0.3 and 0.5 %, known by their "
    "fits to less than 0.5 %, are off by 0.1 to 0.6 %, their root mean square is 0.34 %: with 0.15 % six intervals held, and two "
    "of the four that were no wider",
)  # fmt: skip
_forms = (
    "54 dead volumes and 7 areas that were called off on machines of six draws (X600 to X664), whose laws are not ours: without it 23 of "
    "61 intervals held"
)
VOLUME_FORM = Number(
    0.006, "share of what a chamber holds at half its stroke, one standard deviation",
    "the form of the equations (heat, leaks, flow) leaves so much open of a dead volume",
    f"{_forms}: without a hose they are off by 0.0001 to 0.0097 of that where no more than 2.5 times the noise is left, by 0.02 to 0.03 "
    "where more is",
)  # fmt: skip
HOSE_FORM = Number(
    0.25, "share of a hose's volume, one standard deviation",
    "how that lies along the hose leaves open of it, and of the dead volumes, which it may be counted in",
    f"{_forms}: with a hose dead volumes are off by 0.01 to 0.45 of its volume, hoses with waves always to the smaller side; found volumes "
    "of such hoses by 0.2 to 0.34, to the larger side",
)  # fmt: skip
AREA_FORM = Number(
    0.04, "share, one standard deviation", "what the law of flow leaves open of a valve's area",
    f"{_forms}: areas are off by 0.001, 0.003, 0.015, 0.05, 0.07, 0.10 and 0.11",
)  # fmt: skip
HEAT_FORM = Number(
    0.08, "share, one standard deviation",
    "what the law of heat leaves open of its conductance to the wall; beside a hose, whose wall takes heat too, `HOSE_FORM` comes to it",
    "three cylinders without a hose are off by 0.06, 0.08 and 0.14 (X605, X610, a wall of two layers), five beside one by 0.02, 0.05, "
    "0.08, 0.27 and 0.56 (X576, X606, X641, X671, X690): without it four of eight intervals held",
)  # fmt: skip
HOSE_AREA_FORM = Number(
    0.15, "share, one standard deviation",
    "what the law of flow through a hose leaves open of its area: a tube rubs along its length, and is no nozzle",
    "four hoses that were found on machines of five draws (X576, X673, X690, X713): off by 0.01, 0.14, 0.19 and 0.24 and known by their "
    "fits to 0.01 to 0.2; without it one of four intervals held",
)  # fmt: skip
LAG_FORM = Number(
    2.5e-4, "s, one standard deviation",
    "what a first order leaves open of a valve's delay and time constant: spools are of second order or ramp, and cards filter",
    "nine times on machines of five draws whose other names were found or nearly (X671 to X714): off by 0.01 to 0.44 ms, root mean square "
    "0.23 ms, known by their fits to 0.07 to 0.24 ms: without it four of the nine intervals held. Four more are off by 1.3 to 5 ms where a "
    "hose or other names were missed or a delay stands for a time constant",
)  # fmt: skip
MASS_FORM = Number(
    2.2, "standard errors by the fit, one standard deviation",
    "the laws of friction and the delays of cards leave open of a mass or an inertia, beside the fit's own error",
    "17 masses and 5 inertias that were called off on machines of seven draws (X602 to X685): without it 10 of 22 intervals held. Half are "
    "off by 0.004 at most and known to 0.002, half by 0.02 to 0.07 and known to 0.007 to 0.016, each by so many times its error",
)  # fmt: skip
BEYOND_DOUBT = Number(
    5.0, "standard errors", "what differs by more from its nominal value is listed although it is too small to matter"
)
WORTH = {
    nominal_numbers.FLOW_CAPACITY: Number(0.01, "share", "a valve's area is corrected from here on"),
    nominal_numbers.DEAD_VOLUME: Number(0.03, "share", "a dead volume is corrected from here on"),
    nominal_numbers.PAYLOAD_MASS: Number(0.005, "share", "a mass is corrected from here on"),
    nominal_numbers.JOINT_INERTIA: Number(
        0.01, "share", "the inertia of a joint is corrected from here on: twice as much as what it weighs, for the period of a swing goes "
        "with its root",
    ),
    nominal_numbers.JOINT_DAMPING: Number(0.15, "share", "a joint's damping is corrected from here on"),
}
LAW_SHARE = Number(
    0.14, "logarithm, one standard deviation",
    "by how much a number of an effect that the rig has on differs from the machine's own because its law has another form",
    "healthy machines with the laws of learn makes, whose owners knew such numbers within 5 %: of 29 that a fit moved by more than a tenth "
    "none came nearer to the truth, the farthest was 0.42 away; areas, dead volumes and masses: 16 of 18 came nearer. Weak: few "
    "machines, and within what these allow it was chosen by the answer of one test",
)  # fmt: skip
OPEN_LAW_SHARE = Number(
    0.2, "logarithm, one standard deviation",
    "the same of an effect whose law the rig leaves open: laws that fit as well give it other values",
    "as the former: the velocity of a Stribeck dip, four times, was 0.27 to 0.52 away",
)  # fmt: skip
BEYOND_SHEET = {
    nominal_numbers.PAYLOAD_MASS: Number(
        3.0, "prior standard deviations", "a mass that a fit moved by more is off, however well it is known what it is"
    ),
    nominal_numbers.JOINT_INERTIA: Number(3.0, "prior standard deviations", "the same of an inertia"),
}
HELD_WITHIN = Number(
    2.0, "prior standard deviations",
    "a number that a fit moved further than any data sheet allows is held within so many while effects are asked that it may stand for",
    "derived: 95 % of data sheets",
)  # fmt: skip
STRAINING = Number(
    4.0, "rise of -2 log of the priors of all that is fitted, or of the known numbers of its family",
    "an effect without which the noise explains all is no finding if with it they are so much further off: it stands only beside numbers "
    "that are wrong as well; nor is one without which no more is left than a healthy machine leaves, where the known numbers of its own "
    "family are, or the constant force beside which it looks like a simpler one",
    "asserted: two standard deviations of one number. 24 machines that hide something (X1 to X12, X552 to X569), balances of forces: of 36 "
    "true names below the noise none raises it by more than 1.9; a healthy machine of Cantera's had friction of two directions at 11.4. "
    "Of its own family: drag beside a known film and dip of another shape (X884) 14.9, of 13 true names of X603 to X953 none above 0.2. "
    "Friction of two directions that is one (Cantera, seed 2811282): 13.6 by a constant force that stands against it",
)  # fmt: skip
FAR_FROM_STRAINED = Number(
    0.1, "share of the squared error",
    "an effect that leaves so much more than such a number did is not fitted to the end in its place: it does not explain as much",
)  # fmt: skip
WRONG_NUMBER = Number(
    0.03, "share of rigs", "in which an area or a dead volume is wrong by more than its data sheet allows and nothing else is: a misprint, "
    "another part", "asserted, as the share of sensors whose zero is off",
)  # fmt: skip
MOVED = Number(1e-3, "share", "a parameter that a fit moved by less did not move")
LEAST_PART = Number(0.05, "share of an additive effect", "a smaller part of it is not written into the improved rig")
FEWEST_ALIKE = Count(3, "numbers", "of valve area, two dead volumes and mass so many must be off together for the bore to be asked instead")
SAME_FACTOR = Number(
    1.25, "ratio of the largest factor to the least", "numbers that are off by factors no further apart are off by one",
    "the bench of the README with a bore of 40 mm for 32 mm: valve 1.55, dead volumes 1.69 and 1.63, mass 1.65",
)  # fmt: skip
SAME_GAIN = Number(
    1.01, "ratio of the largest gain to the least", "sensors of the chambers that are all off by gains no further apart are off by one",
    "asserted; a bench whose supply reads 0.4 bar too much: 0.9436 and 0.9437, each known to 0.3 %",
)  # fmt: skip
WRONG_AREA = Number(
    0.15, "share", "one factor that is nearer to 1 is what data sheets leave open",
    "asserted: twice the spread of a valve's area; the next bore of a series differs by a quarter, its area by a half",
)  # fmt: skip
LEAST_OF_TWO_WAYS = Number(
    0.5, "share of the friction of the other direction",
    "seals resist one direction by at least: where less was found, friction that is the same both ways beside a constant force that the "
    "rig lacks, as of a bench that is not level, explains as much",
    "catalogues of lip seals: the two directions differ by up to a half. An own bench of another make, tilted by 7 degrees (12 N beside "
    "10 N of friction), had 19.8 N outwards and 0.1 N inwards",
)  # fmt: skip
ZERO_OF_RANGE = Number(
    0.01, "share of the greatest pressure",
    "zero that an ordinary pressure sensor may have at most: friction of two directions that differ by a force this small may be that of "
    "one. It is no spread, as `priors.FORCE_OF_ZEROS` is: far from the mean that is a normal distribution's tail, and nobody's knowledge. "
    "Odds do not count, for they say that there is friction and not which; nor does what the gas says of the zeros, which errors of its "
    "model move as far (`healthy.ZERO_MODEL`, three of them of two sensors in one force: 5.6 kPa of 6 bar)",
    "data sheets of industrial transmitters state 0.25 to 1 % of range; of 175 zeros of learn makes of machines the largest is 0.8 %. "
    "Make X560: a zero of 5.0 kPa, 0.7 % of its supply, was asymmetric friction, and the gas said 0.7 kPa of it with a standard error "
    "of 1.4; own trial: 2.5 N of true asymmetry on a bore of 32 mm are 0.5 %",
)  # fmt: skip
