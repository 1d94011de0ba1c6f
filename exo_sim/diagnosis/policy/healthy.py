"""What healthy machines show: errors that their models leave, and imperfections that are no findings."""

from __future__ import annotations

from exo_sim.deciding_number import Count, Number

# -- gas ------------------------------------------------------------------------------------------------------------------------
GAS_FLOOR = Number(60.0, "Pa", "what the smoothed position and the windows' starts leave of a prediction at least")
GAS_FLOOR_SHARE = Number(1.5e-4, "share of the pressure's range", "what sensors and the model of a healthy machine leave of it")
GAS_BOUND = Number(
    22.0,
    "units of what is practically significant",
    "discrepancy bound of the gas",
    "128 healthy benches with oddities: three left 16 to 20",
)
USUAL_LEVEL = Number(
    0.6, "share of the supply",
    "mean pressure of a chamber, for that bound: what a flow law gets wrong is in proportion to what drives the flow, and a chamber that a "
    "light spring empties stays far below it",
    "healthy learn makes A to D of whole machines: 0.58 to 0.81, the higher of both chambers; I, one chamber: 0.3, and twice its own "
    "bound; five machines of our own making, no real one",
)  # fmt: skip
LAW_ERROR = Number(
    0.1, "share of what an effect of the rig does, one standard deviation",
    "what its law gets wrong of it, another share for each edge of the valve and for opening and closing: spools close more slowly than "
    "they open, hoses are lines",
    "learnt: greatest marginal likelihood of nine machines that leave much (six healthy ones of makes drawn at random and one of a "
    "stranger's, two with something outside the list): 92, 114, 123, 115, 102 above nil at 0.03, 0.05, 0.1, 0.15, 0.2",
)  # fmt: skip
BURSTS = Number(
    1.6, "level of the lively stretches over the median",
    "errors inside a row that are livelier come in bursts: a pressure rings",
    "208 healthy benches: two above 1.2 (1.32 and 1.41, quiet sensors); ringing hoses at ten limits of detection: 2.8 to 5.3",
)  # fmt: skip
BURST_LENGTH = Count(50, "samples", "over so many the level of the error inside a row is taken")
LIVELY = Number(
    95.0, "percentile of those levels", "the lively stretches lie above it; a sensor's own noise is as loud in every stretch",
    "together with that ratio",
)  # fmt: skip
SKEW = Number(1e-3, "s", "delay between two pressures of one card: their filters")
MOST_CARD_SKEW = Number(2.5e-3, "s", "delay of the card of pressures behind position: filters of 100 to 300 Hz take 0.5 to 1.6 ms")
ZEROS = Number(4.0, "prior standard deviations of a zero", "a pressure sensor's bias is a finding from here on")
ZERO_MODEL = Number(
    1.0, "discrepancy bounds of the gas, one standard deviation", "so far errors of the model move the zero of a pressure sensor",
    "healthy learn makes A to D, I, K, L, seed 930: ten of some 25 zeros were moved beyond doubt, 0.8 to 2.1 bounds from the true ones",
)  # fmt: skip
SCALE = Number(0.003, "share", "a sensor's scale is a finding from here on")
FILM = Number(2.0, "W/(m^2 K)", "heat transfer coefficient that no gas at rest goes below, on the wall of the whole cylinder")
LEAK_AREA = Number(
    1.8e-5, "m^2 per m^3 of swept volume", "a leak that takes minutes to empty a cylinder by half",
    "derived: choked, at room temperature, 194 s",
)  # fmt: skip
LEAK_LAMINAR = Number(
    1.8e-13, "kg/(s Pa^2) per m^3 of swept volume", "the same of a laminar gap", "derived: from 3 bar 220 s, from 7 bar 94 s"
)

# -- forces ---------------------------------------------------------------------------------------------------------------------
FORCE_FLOOR_SHARE = Number(0.008, "share of the forces that act", "what the model of a healthy machine leaves of a balance of forces")
FORCE_BOUND_SHARE = Number(0.03, "share of the forces that act", "discrepancy bound of a balance of forces: this ...")
FORCE_BOUND_STALL = Number(0.003, "share of the full force", "... or, where it is larger, this")
FRICTION_PLACE = Number(
    0.06, "share of the friction", "how much friction depends on the place along the stroke in a healthy machine",
    "learnt on real cylinders (O-ring bench, pulled seals, KDN drive) and on the makes A to D of whole machines",
)  # fmt: skip
FRICTION_SPEED = Number(0.04, "share of the friction", "how much its law of speed is wrong there", "as the former")
FRICTION_DIRECTION = Number(
    0.04, "share of the friction", "how much its law of speed differs between the directions: lips and rails are not symmetric",
    "as the former; EMPS, whose viscous friction differs by a fifth either way, 0.13",
)  # fmt: skip
FRICTION_TIME = Number(0.04, "share of the friction", "how much it drifts within a recording", "as the former")
UNNAMED_FRICTION = Number(
    0.4, "share of the friction", "by how much friction varies with place or time in a machine that is not healthy, one standard deviation",
    "outside cells of learn makes: 0.3 to 0.6 along the stroke, 0.3 to 0.5 as a seal warms",
)  # fmt: skip
FORCE_UNEXPLAINED = Number(5e-4, "share of the forces that act", "what of each is to be added for their sake", "as the former")
DRY_FRICTION = Number(0.002, "share of the full force", "Coulomb friction is a finding from here on")
SPRING = Number(0.02, "share of the full force over the whole stroke", "a return spring is a finding from here on")
CELL_ZERO = Number(0.02, "share of the forces that act", "a force sensor's bias is a finding from here on: zeros drift by 1 to 2 %")
CONTACT_SCATTER = Number(
    1.5, "standard deviation at the slowest speeds in units of that at the others",
    "a contact that hardly slides scatters by more: rows there are worth so much less",
    "learn makes A to D of whole machines: where the piston creeps, what the true law leaves is 3 to 12 times what it leaves elsewhere",
)  # fmt: skip
ONSET_EXCESS = Number(
    2.0, "standard deviations of what its law of speed gets wrong",
    "a healthy contact takes no more than that much more to start than to keep sliding",
    "learn makes with dry and viscous friction hidden, seed 7: 2 % of the level at most where the truth has no dip, half a standard "
    "deviation; of X1 to X12 with one 16 to 100 %. The value between is asserted",
)  # fmt: skip
CREPT = Number(
    3.0, "standard deviations from one onset to the next",
    "an onset that peaks by so much less than the usual one crept before it broke loose",
    "asserted; learn machine X9: with those far below, a true dip was 3 nats ahead, without them 62",
)  # fmt: skip
FEWEST_FOR_FUNCTIONS = Count(30, "rows", "fewer are no reason for a function of place or time of their own in the discrepancy of friction")
SETTLED_SCATTER = Number(
    2.0, "standard deviation in units of that at the other speeds", "laws of speed are not asked where rows of a contact scatter by more"
)
CREEPING = Number(0.1, "share of the fastest speed", "a contact that slides faster does not creep: what is left there is no scatter of it")
STIFF_CONTACT = Number(8e5, "N/m", "stiffness before sliding of the dry contact that any seal shows")
STIFF_TRAVEL = Number(2e-5, "m", "of a contact that slides at a high level of friction, its travel before sliding")
SOFT_CONTACT = Number(2.5e5, "N/m", "only a dry contact softer than this is a finding")

# -- supply ---------------------------------------------------------------------------------------------------------------------
SUPPLY_FLOOR_SHARE = Number(2e-4, "share of the pressure", "what sensors and the flow model of a healthy machine leave")
SUPPLY_BOUND = Number(10.0, "units of what is practically significant", "discrepancy bound of the supply")
