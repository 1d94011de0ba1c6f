"""Single pendulum released freely: dynamicslab MultiArm-Pendulum (MIT licence)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from exo_sim.recording.table import Recording


def read_pendulum(path: Path) -> dict[str, Recording]:
    """Read `SinglePendulumDataForParameterEstimation.mat`: `identify_1` to `_4` and `validate_1` and `_2`.

    `arm.position [rad]` counts from upright; `arm.velocity [rad/s]` is the published rate. Each swing has the clock of
    the whole series: it is one motion cut into six.
    """
    from scipy.io import loadmat

    data = loadmat(path)
    units = {"arm.position": "rad", "arm.velocity": "rad/s"}
    recordings = {}
    for suffix, name in (("id", "identify"), ("vad", "validate")):
        swings = zip(np.ravel(data[f"Time_{suffix}"]), np.ravel(data[f"Y_{suffix}"]))
        for number, (time, states) in enumerate(swings, start=1):
            columns = {"arm.position": states[0].astype(float), "arm.velocity": states[1].astype(float)}
            title = f"{name}_{number}"
            recordings[title] = Recording(
                title, np.ravel(time).astype(float), columns, units, {"source": __doc__ or ""}
            )
    return recordings
