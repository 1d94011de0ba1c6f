from __future__ import annotations

from collections import Counter

from exo_sim import signals, units


def test_a_signal_is_declared_once() -> None:
    assert max(Counter((signal.part, signal.name) for signal in signals.TABLE).values()) == 1


def test_units_of_the_table_are_si() -> None:
    for signal in signals.TABLE:
        for unit in signal.units:
            assert units.scale_and_offset(unit, unit) == (1.0, 0.0)


def test_signals_of_the_contract_are_there() -> None:
    measured = ("valve_command", "pressure_1", "pressure_2", "temperature_1", "temperature_2", "force")
    assert all(signals.find("cylinder", name) in signals.TABLE for name in measured)
    assert signals.find("joint", "external_force") is not None
    assert signals.find("cylinder", "presure_1") is None
    assert signals.column("piston", "force") == "piston.force"
