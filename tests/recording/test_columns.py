"""Headings: name and unit, units of the same kind become SI, and what is none is answered with the nearest."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.errors import RecordingError, UnitError
from exo_sim.recording.columns import LONGEST, heading, resolve, signal_of, split


@pytest.mark.parametrize(("text", "parts"), [("piston.pressure_1 [Pa]", ("piston.pressure_1", "Pa")), (" time[ s ] ", ("time", " s ")),
                                             ("piston.valve_command", ("piston.valve_command", None))])  # fmt: skip
def test_a_heading_is_a_name_and_a_unit(text: str, parts: tuple[str, str | None]) -> None:
    assert split(text) == parts


@pytest.mark.parametrize(
    ("text", "unit", "value", "si"),
    [("piston.pressure_1 [bar]", "Pa", 2.0, 2e5), ("knee.position [deg]", "rad", 180.0, np.pi),
     ("supply.temperature [°C]", "K", 20.0, 293.15),
     ("time [ms]", "s", 5.0, 5e-3), ("piston.valve_command [%]", "1", 50.0, 0.5)],
)  # fmt: skip
def test_units_of_the_same_kind_become_si(text: str, unit: str, value: float, si: float) -> None:
    column = resolve(text)
    assert column.unit == unit and column.to_si(np.array([value]))[0] == pytest.approx(si)
    assert resolve(heading(column.key, column.unit)).scale == 1.0


@pytest.mark.parametrize(
    ("text", "error", "says"),
    [("piston.presure_1 [Pa]", RecordingError, 'did you mean "pressure_1"'), ("piston.pressure_1", UnitError, "has no unit"),
     ("piston.pressure_1 [s]", UnitError, "pressure_1"),
     ("piston.valve_command [V]", UnitError, "a column map can say how many are one"),
     ("piston.pressure_1 [psig]", UnitError, 'column map do it: { column = "piston.pressure_1 [psi]", offset = 14.6959 }'),
     ("piston.pressure_1 [BARG]", UnitError, "is gauge"),
     ("pressure", RecordingError, "not of the form"),
     ("a]b[", RecordingError, "cannot read"),
     ("x" * (LONGEST + 1), RecordingError, "characters")],
)  # fmt: skip
def test_what_is_no_heading_is_one_line(text: str, error: type[Exception], says: str) -> None:
    with pytest.raises(error, match=says.replace("[", r"\[")) as caught:
        resolve(text)
    assert "\n" not in str(caught.value)


def test_signals_of_shared_parts_are_their_own() -> None:
    assert signal_of("supply.pressure").name == "pressure"
    with pytest.raises(RecordingError, match="pressure"):
        signal_of("supply.pressure_1")


def test_numbers_that_cannot_be_written_are_copied() -> None:
    values = np.array([1.0])
    values.flags.writeable = False
    assert resolve("piston.pressure_1 [bar]").to_si(values)[0] == 1e5 and values[0] == 1.0
