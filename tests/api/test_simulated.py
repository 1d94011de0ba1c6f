"""A run as it shows itself."""

from __future__ import annotations

import exo_sim as exo
from exo_sim.api.simulated import Run


def test_a_run_of_a_machine_that_nobody_wears_is_shown_in_words_with_units() -> None:
    summary = {
        "simulated_s": 1.0, "wall_s": 2.0, "cylinders": {},
        "joints": {
            "slide": {"position_error_rms_m": 3.56e-6, "force_peak_n": 2.71},
            "knee": {"position_error_rms_rad": 0.01, "torque_peak_nm": 3.0},
        },
    }
    shown = str(Run(exo.Rig.included("bench"), "swing", summary, (), None, False, None, 0))
    assert "position error 0.00356 mm rms, force 2.71 N peak" in shown and "torque 3 N m peak, position error 0.573 deg rms" in shown
