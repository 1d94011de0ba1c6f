"""Electro-mechanical positioning system: Janot, Gautier, Brunot (2019), nonlinear system identification benchmark."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from exo_sim.recording.table import Recording


def read_emps(path: Path) -> Recording:
    """Read `DATA_EMPS.mat` or `DATA_EMPS_PULSES.mat`.

    `slide.position [m]` is the motor position `qm`; `slide.external_force [N]` the drive force, `gtau` times the
    recorded voltage `vir`. The pulses of the second file are already in that force and are not added.
    """
    from scipy.io import loadmat

    data = loadmat(path)
    columns = {
        "slide.position": np.ravel(data["qm"]).astype(float),
        "slide.external_force": float(data["gtau"].item()) * np.ravel(data["vir"]).astype(float),
    }
    units = {"slide.position": "m", "slide.external_force": "N"}
    name = "pulses" if "pulses_N" in data else "positioning"
    return Recording(name, np.ravel(data["t"]).astype(float), columns, units, {"source": __doc__ or ""})
