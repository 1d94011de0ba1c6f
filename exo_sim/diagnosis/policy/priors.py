"""How far nominal numbers may be off: one standard deviation each."""

from __future__ import annotations

from exo_sim.deciding_number import Number

PREVALENCE = Number(0.1, "share of machines", "that have an effect which does not say itself how common it is")
UNNAMED = Number(0.03, "share of machines", "whose friction depends on place or time by more than every machine's does")
REST_BEYOND = Number(
    5.0, "travels", "beyond the ends of the travel a spring may be slack: from further off it pulls by less than a sixth more at one end "
    "than at the other, which a mass or a sensor's zero says as well",
    "derived: return springs of single-acting cylinders double their force over the stroke",
)  # fmt: skip
BREAKAWAY = Number(
    2.0, "levels of dry friction", "by how much breakaway exceeds it, one standard deviation: published seals show 0.2 to 2",
    "learn make A of whole machines: without it a dip of 700 N over a level of 23 N beside a soft contact stood for one of 12 N",
)  # fmt: skip
FAULTY_ZERO = Number(
    0.03, "share of sensors", "whose zero is off by more than its data sheet allows: beside dry friction seals that differ by direction, "
    "of which one in three does, look the same",
)  # fmt: skip
VALVE_AREA = Number(0.10, "share", "what a data sheet allows of a valve's area, and what tuning has done to it")
DEAD_VOLUME = Number(0.15, "share", "the same of a dead volume")
PRESSURE_ZERO = Number(500.0, "Pa", "zero of a good pressure sensor")
FORCE_OF_ZEROS = Number(
    1200.0, "Pa, one standard deviation",
    "zeros of pressure sensors, as a constant force that no motion can tell from friction that differs by direction: the spread by which "
    "the two are weighed. How large a zero may be at all is `off_nominal.ZERO_OF_RANGE`",
    "175 zeros of learn makes of whole machines: median 0.6 kPa, root mean square 2.4 kPa. With 3 kPa here X560 has its Coulomb friction "
    "for an asymmetric one, X11 its dip besides, X6, X547 and X580 the same names; but 16 N against 24 N on 8 cm^2 have none",
)  # fmt: skip
FORCE_UNMEASURED = Number(
    0.02, "share of the inertial force, one standard deviation", "constant force on a joint of which no force was recorded: it swings free",
    "six swings of one real pendulum, each fitted beside friction and drag with this at 10: 0.003 to 0.033, root mean square 0.023, all of "
    "one sign; what a diagnosis finds there is the same from 0.005 to 0.5, so no recording at hand tells it more closely",
)  # fmt: skip
KNOWN_GAS = Number(0.1, "share", "parameters of effects on the gas that the rig has on already: an owner's numbers are estimates")
KNOWN_FORCE = Number(0.5, "share", "the same of friction and springs: seals wear, and friction in a rig is rarely measured")
REST_HEAT = Number(2.0, "W/K", "heat that walls take from a gas at rest")
HEALTHY_DRY = Number(0.001, "share of the full force", "dry friction of a healthy cylinder")
FORCE_SCALE = Number(
    0.012, "share", "scale of a pressure sensor, a piston's area or a load cell, as forces feel it: data sheets say 0.5 to 2 %"
)
CARD_SKEW = Number(1e-3, "s", "delay of forces behind the position: filters and cards of one instrument differ by 0.5 to 1.6 ms")
MASS = Number(0.05, "share", "mass that a joint moves")
INERTIA = Number(0.05, "share", "inertia of a joint")
ANGLE_ZERO = Number(0.01, "rad or m", "zero of a position sensor, as far as gravity feels it")
DAMPING = Number(0.3, "share", "damping of a joint below its nominal value: a data sheet knows little of it")
SET_PRESSURE = Number(0.02, "share", "set pressure of a regulator")
FARTHEST_SET_PRESSURE = Number(
    0.08, "share", "a measured supply that differs by more from the rig's is another supply: an input, not a sagging one"
)
INITIAL_PRESSURE = Number(1.0, "units of the sensor's noise", "initial pressure of a window, estimated from a few samples")
INITIAL_WARMTH = Number(
    30.0, "K", "by how much gas is off the temperature of the room where a recording begins in the midst of work: filled at once it would "
    "be 117 K warmer, let out from 6 bar 120 K colder, and walls take most of that within seconds",
    "a vessel of another maker's simulator, recorded 0.2 s after a fill: -40 and 21 K, and an error of 5.5 times the noise fell to 1.1",
)  # fmt: skip
MOST_INITIAL_WARMTH = Number(120.0, "K", "derived: adiabatic filling, and emptying from 6 bar")
ROOM_WARM = Number(
    0.1, "spreads of the former",
    "gas whose temperature at the start is, beside walls, known to be that of the room within so much is given that: a number that nobody "
    "needs biases others",
    "a healthy bench without one pressure, -0.6 K with a standard error of 0.6 K: with it free, 0.4 % of hysteresis was a finding",
)  # fmt: skip
UNMEASURED_INITIAL = Number(1e4, "Pa", "initial pressure of a chamber that nobody measured, after the balance of forces gave it")
SENSOR_BIAS_REACH = Number(1.2e5, "Pa", "largest bias of a pressure sensor that is asked for: an atmosphere and something")
SENSOR_SCALE_TYPICAL = Number(0.02, "share", "typical error of a pressure sensor's scale, where a fit of it begins")
SENSOR_DELAY_TYPICAL = Number(2e-3, "s", "typical delay of a sensor, where a fit of it begins; a sample period where that is longer")
SENSOR_SCALE_LEAST = Number(0.8, "factor", "between this and the next the scale of a sensor is looked for")
SENSOR_SCALE_MOST = Number(1.25, "factor", "see the former")
SENSOR_DELAY_REACH = Number(0.05, "s", "largest delay of a sensor that is asked for, of a quick card ...")
SENSOR_DELAY_SAMPLES = Number(
    25.0, "sample periods", "... and of a slow logger: it passes its values on some samples late",
    "pressures of the MBARI spring come 0.23 to 0.35 s late at 50 Hz",
)  # fmt: skip
LEAST_NOISE = Number(0.3, "units of the sensors' noise", "least standard deviation of the noise of a linear family: floors are rounded up")
LEAST_INNOVATION = Number(0.7, "units of the noise of a row", "least standard deviation of an innovation of the error process")
LEAST_AMPLITUDE = Number(1e-2, "share of a healthy machine's", "least amplitude of a discrepancy ...")
MOST_AMPLITUDE = Number(3.0, "share of a healthy machine's", "... and the greatest: what is more is no imperfection of a law")
SIGN_SLACK = Number(0.5, "standard deviations", "amplitudes of effects of one sign may be below zero by so much ...")
WRONG_SIGN = Number(5.0, "log-evidence", "... and what is further below costs this besides")
WIDEST_IN_SERIES = Number(20.0, "areas of the valve", "what is wider in series with a valve restricts nothing, and is not sought")
LEAST_FORCE_SIZE = Number(
    0.02, "share of the forces that act", "the size that an effect on a balance may have before any data is what is missing, at least this"
)
FAMILY_SIZE = Number(
    0.3, "share of what is missing, root mean square", "the size of the effects of a linear family before their spread is estimated"
)
