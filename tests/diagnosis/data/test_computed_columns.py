"""A column without noise was computed: errors of it are held against what a sensor shows, those of a measured one against its noise."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.diagnosis.data.computed_columns import computed, is_computed, remark, shown_noise, was_computed
from exo_sim.recording.table import Recording

TIME = np.arange(4000, dtype=np.float64) * 1e-3
SMOOTH = np.asarray(3e5 + 2e5 * np.sin(3.0 * TIME), dtype=np.float64)
RNG = np.random.default_rng(3)


def test_what_a_sensor_shows_takes_the_place_of_no_noise() -> None:
    assert is_computed(SMOOTH) and shown_noise(1e-3, SMOOTH, True) == pytest.approx(50.0, rel=1e-3)
    assert shown_noise(120.0, SMOOTH, True) == 120.0, "a bound on the noise of more than that stays"


@pytest.mark.parametrize("values", [SMOOTH + RNG.normal(0.0, 5.0, 4000), np.round(SMOOTH, -1), np.full(4000, 6e5), np.full(4000, np.nan)])
def test_a_measured_column_and_one_that_never_changes_keep_their_noise(values: np.ndarray) -> None:
    assert not is_computed(values) and shown_noise(4.0, values, True) == 4.0


def test_columns_count_as_computed_where_every_recording_says_so() -> None:
    still = np.full(4000, 6e5)
    tables = [Recording(name, TIME, {"a.position": SMOOTH, "supply.pressure": still, "a.force": np.round(SMOOTH)}, {}) for name in "xy"]
    assert computed(tables, ["a.position", "supply.pressure", "a.force_balance"]) == ("a.position",)
    assert computed([*tables, Recording("z", TIME, {"a.position": np.round(SMOOTH, -1)}, {})], ["a.position"]) == ()


def test_one_fine_encoder_beside_noisy_columns_was_measured() -> None:
    table = Recording("r", TIME, {"a.position": SMOOTH, "a.external_force": SMOOTH + RNG.normal(0.0, 5.0, 4000)}, {})
    assert not was_computed(table) and shown_noise(1e-3, SMOOTH, was_computed(table)) == 1e-3 and computed([table], ["a.position"]) == ()
    alone = Recording("r", TIME, {"a.position": SMOOTH}, {})
    assert was_computed(alone) and shown_noise(1e-3, SMOOTH, was_computed(alone)) > 1.0
    assert "a.position" in remark(["a.position"]) and "0.01 %" in remark(["a.position"])


def test_few_samples_do_not_show_that_they_have_no_noise() -> None:
    sparse = np.full(4000, np.nan)
    sparse[::300] = 1e5 + 1e3 * RNG.standard_normal(sparse[::300].size)
    assert not is_computed(sparse) and not is_computed(1e5 + 1e3 * RNG.standard_normal(15))
    assert was_computed(Recording("r", TIME, {"a.position": SMOOTH, "a.pressure_1": sparse}, {})), "nor that the rest was measured"


def test_a_fine_encoder_far_from_its_zero_was_measured() -> None:
    fine = 0.1 * np.sin(3.0 * TIME) + 3e-7 * RNG.standard_normal(TIME.size)
    for offset in (0.0, 1000.0):
        assert not was_computed(Recording("r", TIME, {"a.position": fine + offset}, {}))


def test_what_was_smoothed_is_said_to_be_that_or_computed() -> None:
    assert "smoothed or computed" in remark(["a.position"])
