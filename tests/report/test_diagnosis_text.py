"""The summary in a terminal: short, every finding with its numbers, errors of windows and of a free run side by side."""

import re
from dataclasses import replace

from report import made_up_diagnoses as made_up

from exo_sim.diagnosis.findings import SignalFit
from exo_sim.report import diagnosis_text, finding_lines


def test_the_summary_fits_on_a_screen_and_ends_with_the_files():
    many = made_up.whole(effects=(made_up.LEAK,) * 12, sensor_remarks=tuple(f"remark {i}" for i in range(40)))
    for diagnosis in (made_up.whole(), many):
        lines = diagnosis_text.text(diagnosis, ["found/report.html: the page"]).splitlines()
        assert len(lines) <= diagnosis_text.MOST_LINES
        assert max(map(len, lines)) <= finding_lines.WIDTH
        assert lines[-1] == "found/report.html: the page"
    text = diagnosis_text.text(made_up.whole())
    assert "area = 0.0300 mm²  (95 %: 0.0290 to 0.0310 mm²)" in text
    assert "cannot be distinguished: piston leakage 80 %, external leakage 20 %" in text
    assert re.search(r"^  \(\d+ lines more in the report\)$", diagnosis_text.text(many), re.MULTILINE)
    assert diagnosis_text.text(many).count("0.0290 to 0.0310 mm²") == 12


def test_every_finding_is_told_with_its_number_however_many_they_are():
    every = tuple(replace(made_up.LEAK, where=f"cylinder_{i}", ambiguous_with=()) for i in range(50))
    text = diagnosis_text.text(made_up.whole(effects=every))
    assert all(f"piston leakage at cylinder_{i}: area 0.0300 mm² (95 %: 0.0290 to 0.0310 mm²)" in text for i in range(50))
    fewer = diagnosis_text.text(made_up.whole(effects=every[:8]))
    assert "piston leakage at cylinder_0 (missing physics): Gas leaks past the piston." in fewer  # all that is said of the first
    assert len(fewer.splitlines()) <= diagnosis_text.MOST_LINES


def test_a_run_free_stands_beside_the_windows_of_the_same_column_in_the_terminal() -> None:
    runs = {"piston.pressure_1": SignalFit("Pa", 86400.0, 1280.0, 256.0), "slide.position": SignalFit("m", 7.66e-2, 2.85e-4, 2e-5)}
    lines = diagnosis_text.text(made_up.whole(effects=(made_up.LEAK,), free_run=runs)).splitlines()
    rows = [" ".join(line.split()) for line in lines if ("run free" in line and "before" in line) or line.startswith("  slide.position")]
    assert rows == [
        "piston.pressure_1 before 9.42 after 0.279 run free 86.4 1.28 noise 0.250 kPa",
        "slide.position run free 76.6 0.285 noise 0.0200 mm",
    ]
