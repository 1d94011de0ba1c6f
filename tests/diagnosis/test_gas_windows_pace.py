import cylinder_runs
import numpy as np
import pytest

from exo_sim.diagnosis.gas_cut import windows


@pytest.mark.parametrize("seconds", [0.1, 0.5, 1.2])
def test_a_clock_that_changes_its_pace_is_covered_as_well(seconds: float) -> None:
    steps = np.where(np.arange(1000) < 100, 10e-3, 1e-3)
    run = cylinder_runs.run_of(np.linspace(5e5, 4e5, 1000), time=np.cumsum(steps))
    cut = windows(run, seconds)
    assert cut.starts[0] == 0 and cut.stops[-1] == 1000
    assert (np.diff(cut.starts) > 0).all()
