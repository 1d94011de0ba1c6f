"""What happens in one step of the pneumatics, in which order.

A plant is any number of cylinders on one supply and one exhaust. Its state is one vector (`state.py`), its numbers are records
(`plant_records.py`). With every effect off this is the paper: two chambers with their own mass and energy, four metering edges.
"""

from __future__ import annotations

import math

from exo_sim.physics import nozzle
from exo_sim.physics.balances import rates
from exo_sim.physics.compiled import inlined_kernel, kernel
from exo_sim.physics.conditions import Motion
from exo_sim.physics.effects import (
    spool_rate_limit,
    supply_droop,
    supply_regulator,
    valve_deadband,
    valve_hysteresis,
    valve_lag,
    valve_offset,
)
from exo_sim.physics.forces import advance_joints
from exo_sim.physics.friction import dry_level, move_bristle
from exo_sim.physics.nodes import edges_are_told_apart, path_areas, pressures, temperatures, volumes, within
from exo_sim.physics.state import (
    BRISTLE,
    FASTER,
    FELT,
    HELD,
    INTEGRATED,
    PISTON,
    PISTON_SPEED,
    REMEMBERED,
    SHARED,
    SPOOL,
    SPOOL_2,
    SPOOL_SPEED,
    SPOOL_SPEED_2,
    TANK_SPOOL_1,
    TANK_SPOOL_2,
    TANK_SPOOL_SPEED_1,
    TANK_SPOOL_SPEED_2,
)
from exo_sim.physics.step import all_plain, integrate, moving_numbers
from exo_sim.physics.step_length import MOST_STEPS, step_length
from exo_sim.physics.transmission import gives, piston_at

#: What became of a step; where a command is not a number, the cylinder's index is added to the last.
FOLLOWED, TOO_FAST, NO_COMMAND = 0, 1, 2

#: After so long a gas that turned out to be faster than was known is no longer taken to be so [s].
FORGOTTEN = 0.05

#: How many steps may be tried for each that a call may be divided into.
MOST_TRIES = 2

__all__ = ["advance", "pressures", "rates", "step", "temperatures", "volumes"]


@inlined_kernel
def regulator_gain(world, cylinders, spool) -> float:
    """Return a bound on how much the supply's pressure falls for each pascal that it rose, by the flow that this draws."""
    if world.supply_regulator.droop <= 0.0:
        return 0.0
    if supply_droop.present(world.supply_droop):
        return world.supply_regulator.droop * world.supply_droop.conductance
    area = 0.0
    for i in range(len(cylinders)):
        a_s1, _, a_s2, _ = path_areas(cylinders[i], spool[i], spool[len(cylinders) + i])
        area += a_s1 + a_s2
    steepest = nozzle.laminar_flow_factor(world.k) / (1.0 - nozzle.LAMINAR_RATIO)
    return world.supply_regulator.droop * area * steepest * math.sqrt(world.k / (world.r * world.supply_temperature))


@inlined_kernel
def opening(c, spool: float) -> float:
    """Return the relative opening that a spool at this place gives, -1 to 1; the place itself where each edge has its own way to open."""
    if edges_are_told_apart(c):
        return valve_offset.shifted(c.valve_offset, spool)
    return valve_deadband.opening(c.valve_deadband, valve_offset.shifted(c.valve_offset, spool))


@inlined_kernel
def move_spool(c, memory, spool: int, speed: int, command: float, h: float) -> float:
    """Move one spool, at its places in memory, on by `h` seconds of a held command; return its mean relative opening meanwhile."""
    aim = valve_hysteresis.held(c.valve_hysteresis, memory[spool], command)
    wanted, moves = valve_lag.follow(c.valve_lag, memory[spool], memory[speed], aim, 0.5 * h)
    halfway = spool_rate_limit.limited(c.spool_rate_limit, memory[spool], wanted, 0.5 * h)
    moves = spool_rate_limit.limited_speed(c.spool_rate_limit, moves)
    wanted, moves = valve_lag.follow(c.valve_lag, halfway, moves, aim, 0.5 * h)
    memory[spool] = spool_rate_limit.limited(c.spool_rate_limit, halfway, wanted, 0.5 * h)
    memory[speed] = spool_rate_limit.limited_speed(c.spool_rate_limit, moves)
    return opening(c, halfway)


@inlined_kernel
def widest(c, here: float, there: float) -> float:
    """Return the wider of the openings of two places of a spool."""
    opened, will_open = opening(c, here), opening(c, there)
    return opened if abs(opened) > abs(will_open) else will_open


@inlined_kernel
def advance(world, cylinders, state, x0, x1, command, dt, work, scratch, books):
    """Move the whole pneumatic state on by `dt` seconds; return False where the gas is too fast to be followed, and stop there.

    Args:
        world: Record WORLD.
        cylinders: Records CYLINDER, shape (n,).
        state: The state vector; changed in place.
        x0, x1: Piston positions at the start and the end, from the transmission, shape (n,) [m].
        command: Valve commands held over the step, delays already applied, shape (n,); (2 n,), those towards chambers 2 behind the
            others, where a cylinder has a valve for each chamber; (4 n,), those of the paths to a recovery tank behind these.
        work: Scratch, shape (5, integrated_size(n)).
        scratch: Scratch, shape (5, 2 n), or (5, 4 n) with a recovery tank.
        books: Whether the books are kept, and dry contacts followed of pistons, too, that the transmission holds fast: the gas feels
            neither. Where they are not, `work` is zero to begin with.
    """
    n = len(cylinders)
    total = n * INTEGRATED + SHARED
    y = state[:total]
    memory = state[total:]
    shared_memory = n * REMEMBERED
    start, end, x, v, spool = scratch[0], scratch[1], scratch[2], scratch[3], scratch[4]
    for i in range(n):
        start[i], end[i] = x0[i], x1[i]
        c = cylinders[i]
        place = i * REMEMBERED
        if not books and not gives(c):
            continue
        p_1, p_2 = pressures(world, c, y, i * INTEGRATED, memory[place + PISTON] if gives(c) else x0[i])
        if gives(c):
            start[i] = memory[place + PISTON]
            z, before = memory[place + BRISTLE], memory[place + PISTON_SPEED]
            end[i] = piston_at(world, c, p_1, p_2, start[i], x1[i], z, before, dt)
            memory[place + PISTON] = end[i]
        speed = (end[i] - start[i]) / dt
        memory[place + PISTON_SPEED] = speed
        level = dry_level(c, Motion(end[i], speed, memory[place + BRISTLE], p_1 - world.atmosphere, p_2 - world.atmosphere))
        memory[place + BRISTLE] = move_bristle(c, memory[place + BRISTLE], speed, level, dt)
    for i in range(n):  # what the joints do beyond the ends of a stroke does not squeeze the gas
        start[i], end[i] = within(cylinders[i], start[i]), within(cylinders[i], end[i])
    moving = y.size if books else moving_numbers(world, cylinders, y)
    left = dt
    most = world.most_steps if world.most_steps > 0.0 else MOST_STEPS
    tries, known = MOST_TRIES * most, all_plain(world, cylinders)
    while left > 1e-12:
        for i in range(n):
            spool[i] = widest(cylinders[i], memory[i * REMEMBERED + SPOOL], command[i])
            spool[n + i] = -spool[i]
            if cylinders[i].independent > 0.0:
                spool[n + i] = widest(cylinders[i], memory[i * REMEMBERED + SPOOL_2], command[n + i])
            if world.tank_volume > 0.0:
                spool[2 * n + i] = widest(cylinders[i], memory[i * REMEMBERED + TANK_SPOOL_1], command[2 * n + i])
                spool[3 * n + i] = widest(cylinders[i], memory[i * REMEMBERED + TANK_SPOOL_2], command[3 * n + i])
        held, faster = memory[shared_memory + HELD], memory[shared_memory + FASTER]
        h, stages = step_length(world, cylinders, y, held, start, end, spool, left, dt / most, faster)
        for i in range(n):
            place = i * REMEMBERED
            spool[i] = move_spool(cylinders[i], memory, place + SPOOL, place + SPOOL_SPEED, command[i], h)
            spool[n + i] = -spool[i]
            if cylinders[i].independent > 0.0:
                spool[n + i] = move_spool(cylinders[i], memory, place + SPOOL_2, place + SPOOL_SPEED_2, command[n + i], h)
            if world.tank_volume > 0.0:
                spool[2 * n + i] = move_spool(cylinders[i], memory, place + TANK_SPOOL_1, place + TANK_SPOOL_SPEED_1, command[2 * n + i], h)
                spool[3 * n + i] = move_spool(cylinders[i], memory, place + TANK_SPOOL_2, place + TANK_SPOOL_SPEED_2, command[3 * n + i], h)
        drawn, tried, too_fast = integrate(world, cylinders, y, held, start, end, left, spool, h, stages, work, x, v, tries, known, moving)
        tries -= tried
        if tries < 0:
            return False
        if faster + too_fast > 0.0:
            memory[shared_memory + FASTER] = max(faster * math.exp(-h / FORGOTTEN), too_fast)
        slowest = h * regulator_gain(world, cylinders, spool)
        felt = supply_regulator.follow(world.supply_regulator, memory[shared_memory + FELT], drawn, h, slowest)
        memory[shared_memory + FELT] = felt
        memory[shared_memory + HELD] = supply_regulator.stick(world.supply_regulator, held, felt)
        left -= h
    return True


@kernel
def delayed(history, newest, delay, dt):
    """Return the mean over the coming step of a held command that arrives `delay` seconds late.

    Args:
        history: Ring of past commands, one a step, shape (size,).
        newest: Index of the command of this step.
        delay: Seconds.
        dt: Seconds a step.
    """
    before, after, part = arriving(history, newest, delay, dt)
    return after if part == 0.0 else (1.0 - part) * after + part * before


@kernel
def arriving(history, newest, delay, dt):
    """Return what has arrived in the beginning of the coming step, what arrives in it, and after which share of it; as of `delayed`."""
    steps = delay / dt
    whole = math.floor(steps)
    return history[(newest - whole - 1) % history.size], history[(newest - whole) % history.size], steps - whole


@kernel
def arrived_late(history, newest, lag, dt):
    """Return the mean over the coming step of a held command that closes the valve later, or earlier, than it opens it.

    The step is divided where either arrives: of two means it is not known which went together.

    Args:
        history, newest, dt: As of `delayed`.
        lag: Parameters of `valve_lag`.
    """
    prompt, pulled, first = arriving(history, newest, lag.delay, dt)
    held, let_go, second = arriving(history, newest, valve_lag.let_go_after(lag), dt)
    closing, reversal = lag.closing_delay, lag.reversal
    begins, ends = min(first, second), max(first, second)
    mean = begins * valve_lag.arrived(prompt, held, closing, reversal) + (1.0 - ends) * valve_lag.arrived(pulled, let_go, closing, reversal)
    if first < second:
        return mean + (ends - begins) * valve_lag.arrived(pulled, held, closing, reversal)
    return mean + (ends - begins) * valve_lag.arrived(prompt, let_go, closing, reversal)


@inlined_kernel
def step(world, cylinders, joints, vector, history, x0, x1, q0, q1, command, dt, work, scratch):
    """Move everything pneumatic on by one step; return `FOLLOWED`, or why it was refused.

    `history` holds one ring a cylinder and, last, the index of the newest.

    Args:
        vector: The state vector of `state.py`, joint bristles at its end.
        history: Shape (commands, size + 1).
        x0, x1: Transmission lengths less the retracted ones, before and after, shape (n,).
        q0, q1: Positions of the joints that have friction of their own, shape (m,).
        command: Valve commands held over the step, shape (n,), (2 n,) or (4 n,) as of `advance`.
    """
    late = scratch[5]
    size, n = history.shape[1] - 1, len(cylinders)
    for i in range(command.size):
        if math.isnan(command[i]):
            return NO_COMMAND + i
    for i in range(command.size):
        held = min(max(command[i], -1.0), 1.0)
        if size > 1:
            newest = int(history[i, size] + 1.0) % size
            history[i, size] = newest
            history[i, newest] = held
            lag = cylinders[i % n].valve_lag
            if lag.closing_delay != 0.0:
                held = arrived_late(history[i, :size], newest, lag, dt)
            else:
                held = delayed(history[i, :size], newest, lag.delay, dt)
        late[i] = held
    if not advance(world, cylinders, vector, x0, x1, late, dt, work, scratch, True):
        return TOO_FAST
    bristles = vector[vector.size - len(joints) :]
    advance_joints(joints, bristles, q0, q1, dt)
    return FOLLOWED
