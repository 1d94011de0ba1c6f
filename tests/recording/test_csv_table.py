"""Logs as other programs write them: decimal commas, lines above the column names, times of day."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from exo_sim.errors import RecordingError
from exo_sim.recording import read

COLUMNS = '[columns]\n"Zeit" = "time [s]"\n"Weg" = "cart.position [mm]"\n'
ROWS = [(0.01 * i, 100.0 + 0.25 * i) for i in range(40)]


def log(folder: Path, head: str, decimal: str = ".", clock: bool = False) -> Path:
    lines = [f"{f'10:00:{t:06.3f}' if clock else f'{t:.2f}'};{x:.2f}".replace(".", decimal) for t, x in ROWS]
    path = folder / "log.csv"
    path.write_text(head + "Zeit;Weg\n" + "\n".join(lines) + "\n")
    return path


def mapped(folder: Path, file: str = "") -> Path:
    path = folder / "map.toml"
    path.write_text((f"[file]\n{file}\n" if file else "") + COLUMNS)
    return path


@pytest.mark.parametrize("word", ["", "broken"])
def test_decimal_commas(tmp_path: Path, word: str) -> None:
    path = log(tmp_path, "", ",")
    if word:
        path.write_text(path.read_text() + f"0,40;{word}\n")
    recording = read(path, mapped(tmp_path, 'decimal = ","')).recording
    np.testing.assert_allclose(recording.time[:40], [t for t, _ in ROWS])
    np.testing.assert_allclose(recording["cart.position"][:40], [1e-3 * x for _, x in ROWS])


def test_decimal_commas_without_a_word_are_refused_with_the_remedy(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=r'row 1 holds "0,00".*\[file\] decimal = ","'):
        read(log(tmp_path, "", ","), mapped(tmp_path))


def test_a_map_of_the_file_alone_will_do_where_the_names_fit(tmp_path: Path) -> None:
    path, names = tmp_path / "log.csv", tmp_path / "map.toml"
    rows = (f"{t:.2f};1;{x:.2f}\n".replace(".", ",") for t, x in ROWS)
    path.write_text("time [s];cart.positon [mm];cart.position [mm]\n" + "".join(rows))
    names.write_text('[file]\ndecimal = ","\n')
    reading = read(path, names)
    np.testing.assert_allclose(reading.recording["cart.position"], [1e-3 * x for _, x in ROWS])
    assert [finding.kind for finding in reading.findings] == ["unknown column"]


def test_lines_above_the_column_names_are_skipped(tmp_path: Path) -> None:
    recording = read(log(tmp_path, "Messung 17\nBediener: X\n\n"), mapped(tmp_path, "skip = 3")).recording
    assert len(recording.time) == len(ROWS)
    np.testing.assert_allclose(recording["cart.position"], [1e-3 * x for _, x in ROWS])


def test_lines_above_the_column_names_are_refused_with_the_remedy(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=r"line 1 has 1 cells, line 4 has 2.*\[file\] skip = 3"):
        read(log(tmp_path, "Messung 17\nBediener: X\n\n").rename(tmp_path / "other.csv"), mapped(tmp_path, 'delimiter = ";"'))


@pytest.mark.parametrize(
    ("file", "says"),
    [
        ("skip = -1", "skip = -1; write how many lines"),
        ("skip = true", "skip = True"),
        ('decimal = ";"', "decimal = ';'; write"),
        ('decimal = ","\ndelimiter = ","', "not the delimiter"),
        ("skip = 900", "skip = 900 .* leaves no line"),
    ],
)
def test_what_cannot_be_is_one_line(tmp_path: Path, file: str, says: str) -> None:
    with pytest.raises(RecordingError, match=says) as caught:
        read(log(tmp_path, ""), mapped(tmp_path, file))
    assert "\n" not in str(caught.value)


def test_times_of_day_are_refused_with_the_remedy(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=r'"Zeit" holds times of day, first "10:00:00.000"; write it in seconds'):
        read(log(tmp_path, "", clock=True), mapped(tmp_path))
