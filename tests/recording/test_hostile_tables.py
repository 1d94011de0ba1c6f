"""Tables that no instrument should write and some do: read with what was odd said, or refused in one line."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from exo_sim.cli import main
from exo_sim.errors import RecordingError
from exo_sim.recording import Recording, health, read, write_table
from exo_sim.recording import noise as noises
from exo_sim.recording.reader import Reading

HEAD = "time [s],piston.valve_command [1],piston.pressure_1 [Pa]"
ROWS = 300


def cells(row: int) -> list[str]:
    return [f"{row / 100:.2f}", f"{np.sin(row / 30) / 3:.5f}", f"{1.5e5 + 1e4 * np.sin(row / 10):.1f}"]


def table(path: Path, lines: list[str], end: str = "\n", encoding: str = "utf-8") -> Path:
    path.write_bytes(end.join([HEAD, *lines]).encode(encoding, "surrogateescape") + b"\n")
    return path


def rows(at: int, third: str) -> list[str]:
    """Return good rows, one with another last cell."""
    return [",".join([*cells(row)[:2], third] if row == at else cells(row)) for row in range(ROWS)]


def kinds(reading: Reading) -> set[str]:
    return {finding.kind for finding in reading.findings}


@pytest.mark.parametrize("cell", ["\udcff\udcfe", "é", "\x1b[31mred", "1e400", "0x10", "1_000x", "--1", "∞"])
def test_bytes_that_are_no_number_are_a_finding(tmp_path: Path, cell: str) -> None:
    reading = read(table(tmp_path / "a.csv", rows(50, cell)))
    assert len(reading.recording.time) == ROWS
    assert np.isnan(reading.recording["piston.pressure_1"][50])
    assert kinds(reading) & {"words", "infinite"}


def test_bytes_that_are_no_text_in_a_torn_row_are_a_finding(tmp_path: Path) -> None:
    reading = read(table(tmp_path / "a.csv", rows(50, "\udcff,\udcfe,1")))
    assert len(reading.recording.time) == ROWS - 1
    assert kinds(reading) >= {"torn row", "encoding"}


def test_latin_1_headings_are_read(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    lines = [f"{row / 100:.2f},{20 + row % 3}" for row in range(ROWS)]
    path.write_bytes("\n".join(["time [s],piston.temperature_1 [°C]", *lines]).encode("latin-1"))
    reading = read(path)
    assert reading.recording["piston.temperature_1"][0] == pytest.approx(293.15)
    assert kinds(reading) == {"encoding"}


@pytest.mark.parametrize("end", ["\x0b", "\x0c", "\x1c", "\x85", "\u2028"])
def test_only_newlines_end_lines(tmp_path: Path, end: str) -> None:
    """Python's splitlines knows more line ends than a parser of tables: counts of lines then differ."""
    with pytest.raises(RecordingError, match=rf"no row below it: U\+{ord(end):04X} ends no line"):
        read(table(tmp_path / "a.csv", rows(-1, ""), end))
    with pytest.raises(RecordingError, match="ends no line"):  # also where its cells repeat each other
        read(table(tmp_path / "same.csv", ["0,1,1"] * ROWS, end))
    path = table(tmp_path / "b.csv", rows(50, cells(50)[2] + end))
    path.write_bytes(f"# a{end}comment\n".encode() + path.read_bytes())
    assert len(read(path).recording.time) == ROWS


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_every_kind_of_newline_does(tmp_path: Path, end: str) -> None:
    assert len(read(table(tmp_path / "a.csv", rows(-1, ""), end)).recording.time) == ROWS


def test_headings_without_end_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(f"time [s],{'x' * 131_073},p.pressure_1 [Pa]\n" + "1,2,3\n" * 20)
    with pytest.raises(RecordingError, match="field larger"):
        read(path)
    path.write_text("time [s]," + ",".join(f"p{i}.pressure_1 [Pa]" for i in range(6000)) + "\n" + "1,2,3\n" * 20)
    with pytest.raises(RecordingError, match="6001 columns"):
        read(path)
    path.write_text(f"time [s],p.pressure_1 [Pa],{' ' * 50_000}]\n" + "".join(f"{row},2,3\n" for row in range(20)))
    assert "unknown column" in kinds(read(path))


#: Numbers of rows to a series.
Series = Callable[[np.ndarray], np.ndarray]


@pytest.mark.parametrize("values", [
    lambda i: 1e300 * (-1.0) ** i, lambda i: 1e300 * np.sin(i), lambda i: 1e5 * (1 + i % 2), lambda i: 5e-324 * i,
    lambda i: 1e-300 * np.sin(i), lambda i: (-1.0) ** i * 1e29, lambda i: 0.0 * i, lambda i: np.where(i % 4 < 2, 1e5, 2e5),
])  # fmt: skip
@pytest.mark.parametrize("clock", [lambda i: 0.01 * i, lambda i: 0.01 * (i - i % 2) + 1e-15 * (i % 2), lambda i: 1e-7 * 3.0 ** (i % 60)])
def test_values_of_every_size_go_through_every_question(
    tmp_path: Path, values: Series, clock: Series, capsys: pytest.CaptureFixture[str]
) -> None:
    i = np.arange(ROWS)
    keys = {"piston.pressure_1": "Pa", "slide.position": "m", "slide.velocity": "m/s"}
    with np.errstate(all="ignore"):
        recording = Recording("r", clock(i), {key: values(i) * 1.0 for key in keys}, keys)
    write_table(tmp_path / "a.parquet", recording)
    status = main(["inspect", str(tmp_path / "a.parquet"), "--json"])
    said = capsys.readouterr()
    assert status in (0, 2) and "Warning" not in said.err and said.err.count("\n") == (status == 2)
    if status == 0:
        json.loads(said.out)


@pytest.mark.parametrize("step", [5e-324, 1e-300, 1e300])
def test_a_clock_of_no_size_is_refused(tmp_path: Path, step: float) -> None:
    rows = np.arange(ROWS, dtype=float)
    recording = Recording("r", step * rows, {"piston.pressure_1": rows}, {"piston.pressure_1": "Pa"})
    write_table(tmp_path / "a.parquet", recording)
    with pytest.raises(RecordingError, match=r'the clock steps by|"time"'):
        read(tmp_path / "a.parquet")


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.floats(allow_nan=True, allow_infinity=False, width=64), min_size=20, max_size=80), st.integers(1, 4))
def test_the_noise_of_anything_is_a_number(values: list[float], repeats: int) -> None:
    series = np.tile(np.clip(values, -1e30, 1e30), repeats)
    found = noises.floor(series, np.arange(len(series), dtype=float) * 1e-3)
    assert np.isfinite([found.std, found.white, found.correlated, found.step]).all()


@pytest.mark.parametrize("name", ["pipe.csv", "pipe.parquet", "pipe.rrd"])
def test_a_pipe_or_device_is_refused_unread(tmp_path: Path, name: str) -> None:
    os.mkfifo(tmp_path / name)
    (tmp_path / "zero").mkdir()
    (tmp_path / "zero" / name).symlink_to("/dev/zero")
    for path in (tmp_path / name, tmp_path / "zero" / name):
        with pytest.raises(RecordingError, match="not a file"):
            read(path)


def test_a_name_that_is_no_utf8_is_read_and_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = table(tmp_path / "\udcff\x1b.csv", rows(-1, ""))
    assert main(["inspect", str(path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["name"] == "\\udcff\\u001b"
    assert main(["inspect", str(path)]) == 0
    assert "\x1b" not in capsys.readouterr().out
    assert health.check(read(path).recording) is not None
