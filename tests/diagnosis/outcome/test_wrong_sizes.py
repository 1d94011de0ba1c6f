"""Numbers that are all off by one factor speak for a wrong bore; a rig that no finding betters, for sizes that no fit moves."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pytest

from exo_sim.diagnosis.findings import Estimate, Finding, Kind, SignalFit
from exo_sim.diagnosis.outcome.wrong_sizes import advice, still_far, suspected_bores
from exo_sim.rig import Rig

RIG = cast(Rig, SimpleNamespace(path=Path("j.toml"), cylinders={"piston": SimpleNamespace(bore=0.04)}))
FAR = SignalFit("m", 0.114, 0.1, 2e-5)


def off(name: str, where: str, **factors: float) -> Finding:
    return Finding(name, where, Kind.CALIBRATION, "", {key: Estimate(value, "1", value, value) for key, value in factors.items()}, 9.0, 0.0)


def numbers(valve: float, dead_1: float, dead_2: float, mass: float = 0.0) -> list[Finding]:
    found = [off("flow_capacity", "piston", factor=valve)]
    found.append(off("dead_volume", "piston", factor=dead_1, dead_volume_1=dead_1, dead_volume_2=dead_2))
    return found + ([off("payload_mass", "slide", factor=mass)] if mass else [])


def test_one_factor_for_all_is_a_bore() -> None:
    bores = suspected_bores(numbers(1.55, 1.69, 1.63, 1.65), RIG, {"piston": "slide"})
    assert bores == {"piston": pytest.approx(0.0313, abs=2e-4)}
    said = advice(numbers(1.55, 1.69, 1.63), {}, bores, RIG)
    assert "cylinders.piston of j.toml, 40 mm" in said and "31.3 mm" in said
    assert suspected_bores(numbers(0.63, 0.6, 0.58), RIG, {})["piston"] > 0.05


@pytest.mark.parametrize("factors", [(1.55, 1.69, 0.7), (1.55, 1.05, 1.63), (1.1, 1.12, 1.08), (2.5, 1.3, 1.4)])
def test_numbers_that_are_off_each_for_itself_are_none(factors: tuple[float, float, float]) -> None:
    assert suspected_bores(numbers(*factors), RIG, {}) == {}


def test_two_numbers_are_too_few() -> None:
    assert suspected_bores([*numbers(1.6, 1.6, 1.6)[:1], off("payload_mass", "slide", factor=1.6)], RIG, {"piston": "slide"}) == {}


def test_a_rig_that_no_finding_betters_has_its_sizes_checked() -> None:
    assert still_far({"slide.position": FAR, "piston.pressure_1": SignalFit("Pa", 8e4, 300.0, 250.0)}) == ("slide.position", FAR)
    assert advice(numbers(1.1, 1.1, 1.1), {"slide.position": FAR}, {}, RIG) == "bore, rod, stroke and mass in j.toml"
    assert "moment arm" in advice(numbers(1.1, 1.1, 1.1), {"hinge.position": FAR}, {}, RIG, {"piston"})
    swing = cast(Rig, SimpleNamespace(path=Path("j.toml"), cylinders={}))
    assert advice(numbers(1.1, 1.1, 1.1), {"hinge.position": FAR}, {}, swing) == "masses and lengths in j.toml"
    assert advice([], {"slide.position": FAR}, {}, RIG) == ""
    better, near = SignalFit("m", 0.114, 0.05, 2e-5), SignalFit("m", 1e-3, 1e-3, 2e-5)
    assert still_far({"a": better, "b": near}) is None and advice(numbers(1.1, 1.1, 1.1), {"a": better}, {}, RIG) == ""
