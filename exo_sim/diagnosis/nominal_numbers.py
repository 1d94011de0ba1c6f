"""Names of the numbers that every fit moves because no data sheet is exact; in a result they stand where else an effect's name does."""

from __future__ import annotations

#: Factors on numbers of the rig: the area of a valve, a dead volume, what a joint moves, its inertia and its damping.
FLOW_CAPACITY, DEAD_VOLUME = "flow_capacity", "dead_volume"
PAYLOAD_MASS, JOINT_INERTIA, JOINT_DAMPING = "payload_mass", "joint_inertia", "joint_damping"
#: Set pressure of a supply that was not recorded, as a factor on the nominal one.
SET_PRESSURE = "set_pressure"
#: Zero of a pressure sensor, which every fit of a gas moves.
ZERO = "sensor_zero"
#: Constant force in a balance of forces: the zeros of all that it is made of.
FORCE_OFFSET = "offset"
#: Scale of a column in a balance of forces.
SENSOR_GAIN = "sensor_gain"
#: Delays: of both pressures of a cylinder together, of its position, and of all that drives a joint against its position.
CARD_OF_PRESSURES, POSITION_DELAY, DRIVE_DELAY = "pressures.delay", "position.delay", "drive.delay"
#: Temperature of the gas where a recording begins: of the recording, not of the machine.
INITIAL_TEMPERATURE = "initial_temperature"
