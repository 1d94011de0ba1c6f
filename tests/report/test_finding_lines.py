"""One finding in the terminal: in full, and in a line."""

from __future__ import annotations

from dataclasses import replace

from report import made_up_diagnoses as made_up

from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.report import finding_lines


def test_a_line_holds_name_place_number_interval_and_probability() -> None:
    assert " ".join(" ".join(finding_lines.brief(made_up.LEAK)).split()) == (
        "piston leakage or external leakage at piston: area 0.0300 mm² (95 %: 0.0290 to 0.0310 mm²); probability 95 %"
    )
    assert finding_lines.brief(made_up.AREA) == ["  flow capacity at piston: factor × 1.0200 (95 %: 1.0180 to 1.0220); probability 95 %"]


def test_of_many_numbers_those_furthest_from_nil_stand_in_it() -> None:
    """Of a valve whose exhaust edges are half as large its overlaps, which are nil, are what nobody asks for."""
    nil = {f"overlap_{i}": Estimate(0.002, "1", -0.02, 0.02) for i in range(3)}
    small = {f"excess_exhaust_{i}": Estimate(-0.58, "1", -0.585, -0.575) for i in (1, 2)}
    edges = Finding("valve_edges", "piston", Kind.MISSING_PHYSICS, "Edges differ.", {**nil, **small}, 9.0, 0.0)
    said = " ".join(finding_lines.brief(edges))
    assert said.index("overlap 0") < said.index("excess exhaust 1") < said.index("excess exhaust 2") < said.index("2 numbers more")


def test_a_factor_of_one_is_none_of_it() -> None:
    usual = {f"volume_{i}": Estimate(1.0001, "1", 1.0, 1.0002) for i in range(3)}
    off = {"volume_3": Estimate(1.4, "1", 1.2, 1.6)}
    volumes = Finding("dead_volume", "piston", Kind.CALIBRATION, "Off.", {**usual, **off}, 9.0, 0.0)
    assert "volume 3" in " ".join(finding_lines.brief(volumes))


def test_of_many_numbers_some_stand_in_it_and_without_one_what_is_said() -> None:
    four = {f"overlap_{i}": Estimate(0.02, "1", 0.01, 0.03) for i in range(4)}
    edges = Finding("valve_edges", "piston", Kind.MISSING_PHYSICS, "Edges differ.", four, 9.0, 0.0)
    said = " ".join(finding_lines.brief(edges))
    assert "overlap 2" in said and "overlap 3" not in said and "1 number more in the report" in said
    stuck = replace(edges, name="sensor_stuck", parameters={}, says="It is stuck.", log10_odds=0.0)
    assert finding_lines.brief(stuck) == ["  sensor stuck at piston: It is stuck"]


def test_in_full_everything_is_said() -> None:
    lines = finding_lines.full(made_up.LEAK)
    assert lines[0] == "  piston leakage at piston (missing physics): Gas leaks past the piston."
    assert "    area = 0.0300 mm²  (95 %: 0.0290 to 0.0310 mm²)" in lines
    assert lines[-1] == "    cannot be distinguished: piston leakage 80 %, external leakage 20 %"
