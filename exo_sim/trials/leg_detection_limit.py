"""How far a leg's recording is from the same leg without what is hidden: the likelihood ratio of `detection_limit`.

The joint is led, so nothing drifts away and the whole recording is one window: the same motion and the same command
drive the cylinder with and without the effect.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.trials.detection_limit import UNCERTAIN
from exo_sim.trials.leg_cases import LegCase, with_faults
from exo_sim.trials.truth.instruments import measure
from exo_sim.trials.truth.loop import run_led
from exo_sim.trials.truth.machine import Machine
from exo_sim.trials.truth.state import LOG, at_rest

Array = NDArray[np.float64]

STRIDE = 5
_UNCERTAIN = {name: deviation for name, deviation in UNCERTAIN.items() if name != "load_mass"}
_OFFSETS = (500.0, 500.0, 2.0)
_COLUMNS = ("pressure_1", "pressure_2", "force")


def distance(case: LegCase) -> float:
    """Return the distance in standard deviations, over the cylinder in question."""
    joint, truth = case.joint, case.truth[case.joint]
    pressure, force = case.instruments
    has_cell = f"{joint}.force [N]" in case.recordings[0]
    plain = case.bench.cylinders[joint].machine().with_(load_mass=1.0, gravity=0.0, damping=0.0, spring_stiffness=0.0)
    sigma = np.array([pressure.noise, pressure.noise, force.noise if has_cell else math.inf])
    weight = math.sqrt(STRIDE) / sigma
    time = truth.log["time"][:-1]
    at_valve = any(entry.parameters.get("sensor_at_valve", 0) for entry in case.hidden)
    shown = np.empty((len(time), 3))
    for j, name in enumerate(_COLUMNS):
        key = "line" + name[-2:] if at_valve and j < 2 else name
        one = with_faults(force if j == 2 else pressure, f"{joint}.{name}", case.hidden)
        clean = replace(one, noise=0.0, bits=0)
        shown[:, j] = measure(time, truth.log[key][:-1], clean, np.random.default_rng(0))

    def predict(machine: Machine, p1: float = 1.0, p2: float = 1.0) -> Array:
        record = machine.packed()
        x, v = truth.log["position"], truth.log["velocity"]
        y = at_rest(x[0], truth.log["pressure_1"][0] * p1, truth.log["pressure_2"][0] * p2, record[0])
        n = len(x) - 1
        log = np.empty((n, len(LOG)))
        given, command = np.full(n, 2, np.int64), truth.log["command"][:n]
        run_led(record, y, np.zeros(4), truth.ticks[:n], truth.dt, x, v, given, command, np.zeros(3), log)
        return log[:, [LOG.index(name) for name in _COLUMNS]]

    base = predict(plain)

    def view(values: Array) -> Array:
        return (values[::STRIDE] * weight).ravel()

    columns = [
        view(predict(plain.with_(**{name: plain[name] * (1 + 0.2 * deviation)})) - base) / 0.2
        for name, deviation in _UNCERTAIN.items()
        if plain[name] > 0
    ]
    columns += [view(np.broadcast_to(unit, base.shape)) for unit in np.diag(_OFFSETS)]
    # where the gas started is free within 1 %
    columns += [view(predict(plain, 1.001) - base) * 10, view(predict(plain, 1.0, 1.001) - base) * 10]
    table = np.column_stack(columns)
    missed = view(shown - base)
    gain = table.T @ missed
    best = np.linalg.solve(table.T @ table + np.eye(len(columns)), gain)
    return math.sqrt(max(float(missed @ missed - gain @ best), 0.0))
