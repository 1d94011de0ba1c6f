"""Seals of 3D-printed pneumatic actuators: friction and leakage, E. Zillen (PMC10907517, CC0)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from exo_sim.recording.table import Recording

_ATMOSPHERE = 101325.0
#: Where the laser reads zero, as X of the piston; the drawings do not say, so this is a belief. Metres.
_LASER_ZERO = 0.040
#: Where the piston is held in the pressure decay; a belief as well. Metres.
_HELD_AT = 0.025


def read_friction(path: Path) -> Recording:
    """Read a file of `friction/`: a piston pushed in and let out slowly at constant pressure.

    The force is higher while the recorded position grows, so that direction is inward, against the pressure; it is
    turned round: `slide.position` grows outward. The machine's force holds the piston in: `slide.external_force` is the
    measured force, negative. Gauge pressure plus one standard atmosphere.
    """
    table = np.loadtxt(path, delimiter="\t")
    columns = {
        "piston.pressure_1": 1e5 * table[:, 5] + _ATMOSPHERE,
        "slide.position": _LASER_ZERO - 1e-3 * table[:, 4],
        "slide.external_force": -table[:, 6],
    }
    units = {"piston.pressure_1": "Pa", "slide.position": "m", "slide.external_force": "N"}
    return Recording(path.stem, 1e-3 * table[:, 0], columns, units, {"source": __doc__ or ""})


def read_pressure_decay(path: Path) -> Recording:
    """Read a file of `pressure_decay/`: a closed chamber left alone.

    Times from 1000 ms on carry dots between thousands as well. `piston.valve_command` is 0: closed throughout.
    `slide.position` is constant.
    """
    rows = [line.split(";") for line in path.read_text(encoding="utf-8").split()]
    time = np.array([1e-3 * float(_without_thousands(row[0])) for row in rows])
    gauge = np.array([float(row[2]) for row in rows])
    columns = {
        "piston.valve_command": np.zeros(len(time)),
        "piston.pressure_1": 1e5 * gauge + _ATMOSPHERE,
        "slide.position": np.full(len(time), _HELD_AT),
    }
    units = {"piston.valve_command": "1", "piston.pressure_1": "Pa", "slide.position": "m"}
    return Recording(path.stem, time, columns, units, {"source": __doc__ or ""})


def _without_thousands(number: str) -> str:
    whole, _, decimals = number.rpartition(".")
    return whole.replace(".", "") + "." + decimals
