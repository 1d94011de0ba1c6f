"""Two-chamber nitrogen spring of a wave-energy converter on a test machine: MBARI, osrf/mbari_wec_gz (Apache-2.0)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from exo_sim import units
from exo_sim.recording.table import Recording

_COLUMNS = {
    "Pos(in)": "m",
    "LowerSpringPressure(psia)": "Pa",
    "UpperSpringPressure(psia)": "Pa",
    "TestMachineForce(lbs)": "N",
}
_UNITS = {"in": "inch", "psia": "psi", "lbs": "lbf"}


def read_gas_spring(path: Path, with_force: bool = False) -> Recording:
    """Read a `.exp` file.

    The pressure of the lower chamber rises with the position (correlation 0.98) and that of the upper falls, so the
    lower one shrinks and is chamber 2, on the rod's side, where the published area is the smaller, too. The spring has
    no valve: `spring.valve_command` is absent.

    Args:
        path: The file; its first line names the columns.
        with_force: Also give the test machine's force as `piston.external_force`, + pulling the rod out. It drives the
            hydraulic generator in parallel as well, so it is not the force on the spring alone.
    """
    with path.open(encoding="utf-8") as file:
        names = file.readline().lstrip("#").strip().split(",")
        table = np.loadtxt(file)
    values = {}
    for name, si_unit in _COLUMNS.items():
        unit = name.partition("(")[2].rstrip(")")
        scale, _ = units.scale_and_offset(_UNITS[unit], si_unit)
        values[name] = scale * table[:, names.index(name)]
    columns = {
        "spring.pressure_1": values["UpperSpringPressure(psia)"],
        "spring.pressure_2": values["LowerSpringPressure(psia)"],
        "piston.position": values["Pos(in)"],
    }
    si = {"spring.pressure_1": "Pa", "spring.pressure_2": "Pa", "piston.position": "m"}
    if with_force:
        columns["piston.external_force"] = values["TestMachineForce(lbs)"]
        si["piston.external_force"] = "N"
    return Recording("gas_spring", table[:, names.index("time(s)")], columns, si, {"source": __doc__ or ""})
