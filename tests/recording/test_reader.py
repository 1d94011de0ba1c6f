"""Recordings as real ones are: what can be read is read and said, what cannot is refused in one line."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pyarrow import parquet

from exo_sim.errors import ExoSimError, RecordingError
from exo_sim.recording import column_selection, read
from exo_sim.recording.health import check
from exo_sim.recording.reader import Reading

HEADING = "time [s],piston.pressure_1 [Pa]\n"
BODY = "".join(f"{i * 0.001:.3f},{100000 + i}\n" for i in range(20))


def file(folder: Path, text: str | bytes, name: str = "bench.csv") -> Path:
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def numbered(rows: int, cells: str = "{i},{i}\n") -> str:
    return "".join(cells.format(i=i) for i in range(rows))


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_any_delimiter_mark_comment_and_blank_line(tmp_path: Path, delimiter: str) -> None:
    text = "\n# from the bench\n" + HEADING + "\n" + BODY + "# the end\n\n"
    reading = read(file(tmp_path, b"\xef\xbb\xbf" + text.replace(",", delimiter).encode()))
    assert reading.recording.name == "bench"
    assert reading.findings == ()
    np.testing.assert_allclose(reading.recording.time, np.arange(20) * 1e-3)
    np.testing.assert_array_equal(reading.recording["piston.pressure_1"], 100000.0 + np.arange(20))


@pytest.mark.parametrize(
    "heading,si,unit",
    [
        ("p.pressure_1 [bar]", 1e5, "Pa"),
        ("p.pressure_1 [psi]", 6894.757293168361, "Pa"),
        ("k.position [deg]", np.pi / 180.0, "rad"),
        ("k.position [mm]", 1e-3, "m"),
        ("k.external_force [Nm]", 1.0, "N*m"),
        ("k.velocity [deg/s]", np.pi / 180.0, "rad/s"),
        ("p.force [lbf]", 4.4482216152605, "N"),
        ("p.valve_command [%]", 0.01, "1"),
    ],
)
def test_units_become_si(tmp_path: Path, heading: str, si: float, unit: str) -> None:
    recording = read(file(tmp_path, f"time [ms],{heading}\n" + numbered(12))).recording
    key = heading.split(" [", maxsplit=1)[0]
    np.testing.assert_allclose(recording[key], si * np.arange(12), rtol=1e-9)
    np.testing.assert_allclose(recording.time, 1e-3 * np.arange(12))
    assert recording.units[key] == unit


def test_temperatures_have_an_offset(tmp_path: Path) -> None:
    recording = read(file(tmp_path, "time [s],supply.temperature [degC]\n" + numbered(12))).recording
    np.testing.assert_allclose(recording["supply.temperature"], 273.15 + np.arange(12))


@pytest.mark.parametrize(
    "text,says",
    [
        ("", "the file is empty"),
        ("\n\n", "the file is empty"),
        (HEADING, "no row below it"),
        ("# only words\n", "only comments"),
        (numbered(20), "numbers where the column names should be"),
        ("time,p.pressure_1 [Pa]\n" + numbered(20), 'write "time [s]"'),
        ("t [s],p.pressure_1 [Pa]\n" + numbered(20), 'no column "time [s]"'),
        ("time [s],p.presure_1 [Pa]\n" + numbered(20), '"pressure_1"'),
        ("time [s],p.pressure_1 [barr]\n" + numbered(20), 'unknown unit "barr"'),
        ("time [s],p.pressure_1 [m]\n" + numbered(20), '"m" is not a unit of this kind'),
        ("time [s],p.pressure_1\n" + numbered(20), "has no unit"),
        ("time [s],p.pressure_1 [bar gauge]\n" + numbered(20), "gauge"),
        ("time [s],p.pressure_2 [Pa],p.pressure_1 [psig]\n" + numbered(20, "{i},{i},{i}\n"), "gauge"),
        ("time [s],p.pressure_1 [Pa],p.pressure_1 [bar]\n" + numbered(20, "{i},{i},{i}\n"), "both p.pressure_1"),
        ("time [s],p.pressure_1 [Pa],p.pressure_1 [Pa]\n" + numbered(20, "{i},{i},{i}\n"), "2 times"),
        ("time [s];p.pressure_1 [Pa]\n" + numbered(20, "0,{i};1\n"), "decimal commas"),
        ("time [s],p.pressure_1 [Pa]\n" + numbered(20, "0,{i},1,5\n"), "decimal commas"),
        ("time [s],p.pressure_1 [Pa]\n" + numbered(20, "{i},{i}\n{i}\n"), "more or fewer cells"),
        ("time [s],p.pressure_1 [Pa]\n" + numbered(20, "{i},on\n"), "holds words"),
        ("time [s],p.pressure_1 [Pa]\n" + numbered(20, "{i},nan\n"), "no column beside the time holds a number"),
        ("time [s],p.pressure_1 [Pa]\n" + numbered(20, "nan,{i}\n"), "holds no numbers"),
        ("time [s],p.pressure_1 [Pa]\n0,1\n1,2\n", "2 usable rows; at least 10 are needed"),
        ("time [s],p.pressure_1 [Pa]\n" + "7,1\n3,1\n" * 20, "2 usable rows of 40; at least 10 are needed"),
        ("time [s],p.pressure_1 [Pa]\n" + "7,1\n3,1\n" * 20, "; sort the rows by time"),
        ("time [s] p.pressure_1 [Pa]\n" + numbered(20, "{i} {i}\n"), "line 2 holds 2 numbers with blanks between"),
        (b"\0\1\2", "not text"),
        (b"\xff\xfet\0", "UTF-16"),
    ],
)
def test_what_cannot_be_read_is_one_line(tmp_path: Path, text: str | bytes, says: str) -> None:
    path = file(tmp_path, text)
    with pytest.raises(RecordingError) as caught:
        read(path)
    message = str(caught.value)
    assert says in message
    assert "\n" not in message
    assert "bench.csv" in message


def test_a_column_without_a_name_is_left_out_with_a_note(tmp_path: Path) -> None:
    found = read(file(tmp_path, "time [s],p.pressure_1 [Pa],\n" + numbered(20, "{i},{i},\n"))).findings
    assert [(one.says, one.severity) for one in found] == [("column 3 has no name; it was left out", "info")]


def test_one_row_is_said_in_the_singular(tmp_path: Path) -> None:
    found = read(file(tmp_path, "time [s],p.pressure_1 [Pa]\n" + numbered(20) + "nan,1\n20,1e400\n")).findings
    assert [one.says for one in found] == [
        '"time" has no number in 1 row, first row 21; dropped',
        '"p.pressure_1" is infinite, or more than any sensor reads, in 1 row, first row 21; taken as missing',
    ]


def test_missing_numbers_of_a_parquet_in_groups_of_rows_stay_missing(tmp_path: Path) -> None:
    pressure = [None if i % 7 == 3 else 1e5 + i for i in range(50)]
    whole = pa.table({"time [s]": np.arange(50.0), "p.pressure_1 [Pa]": pressure})
    parquet.write_table(whole, tmp_path / "a.parquet", row_group_size=8)
    found = read(tmp_path / "a.parquet").recording["p.pressure_1"]
    np.testing.assert_array_equal(found, [np.nan if one is None else one for one in pressure])


@pytest.mark.parametrize("name", ["no.csv", "no.rrd", "no.parquet"])
def test_missing_and_cut_files(tmp_path: Path, name: str) -> None:
    with pytest.raises(RecordingError, match="no such recording"):
        read(tmp_path / name)
    with pytest.raises(RecordingError, match="empty"):
        read(file(tmp_path, b"", name))
    if not name.endswith("csv"):
        with pytest.raises(RecordingError, match="not a whole"):
            read(file(tmp_path, b"RRF2 nonsense PAR1", name))
    with pytest.raises(RecordingError, match="folder"):
        read(tmp_path)
    with pytest.raises(RecordingError, match="ends in"):
        read(file(tmp_path, b"x", "a.xlsx"))


def test_a_cut_parquet(tmp_path: Path) -> None:
    path = tmp_path / "a.parquet"
    parquet.write_table(pa.table({"time [s]": np.arange(1000.0), "p.pressure_1 [Pa]": np.arange(1000.0)}), path)
    path.write_bytes(path.read_bytes()[:-500])
    with pytest.raises(RecordingError, match="not a whole Parquet"):
        read(path)


def kinds(reading: object) -> list[tuple[str, str, str]]:
    return [(finding.column, finding.kind, finding.use) for finding in reading.findings]  # type: ignore[attr-defined]


def test_what_is_odd_is_said_and_the_rest_used(tmp_path: Path) -> None:
    text = "piston.presure_2 [Pa],time [s],piston.pressure_1 [Pa],slide.position [furlongish],piston.force [N]\n"
    text += (
        "".join(f"1,{i * 1e-3},{'ERR' if i == 5 else i},{i},{'inf' if i == 7 else i}\n" for i in range(300)) + "1,0.3"
    )
    reading = read(file(tmp_path, text))
    assert kinds(reading) == [
        ("piston.presure_2 [Pa]", "unknown column", "set aside"),
        ("slide.position [furlongish]", "unit", "set aside"),
        ("bench.csv", "torn row", "repaired"),
        ("piston.pressure_1", "words", "repaired"),
        ("piston.force", "infinite", "repaired"),
    ]
    assert 'or "pressure_1"?' in reading.findings[0].says
    assert "row 6" in reading.findings[3].says
    assert np.flatnonzero(np.isnan(reading.recording["piston.pressure_1"])).tolist() == [5]
    assert set(reading.recording.columns) == {"piston.pressure_1", "piston.force"}


def clock(tmp_path: Path, times: np.ndarray) -> Reading:
    return read(file(tmp_path, HEADING + "".join(f"{t!r},{i}\n" for i, t in enumerate(times.tolist()))))


def test_a_clock_that_steps_back_a_little(tmp_path: Path) -> None:
    times = np.arange(1000) * 1e-3
    times[600:] -= 0.05
    reading = clock(tmp_path, times)
    assert kinds(reading) == [("time", "clock", "repaired")]
    assert "row 601" in reading.findings[0].says
    assert (np.diff(reading.recording.time) > 0).all()
    assert len(reading.recording.time) == 950
    assert reading.breaks == (pytest.approx(0.6),)


def test_a_clock_that_starts_again(tmp_path: Path) -> None:
    reading = clock(tmp_path, np.concatenate((np.arange(300), np.arange(700))) * 1e-3)
    assert kinds(reading) == [("time", "clock", "set aside")]
    assert len(reading.recording.time) == 700
    assert reading.recording["piston.pressure_1"][0] == 300.0


def test_a_clock_that_runs_backwards_stands_or_has_holes(tmp_path: Path) -> None:
    back = clock(tmp_path, np.arange(100)[::-1] * 1e-3)
    assert back.recording["piston.pressure_1"][0] == 99.0
    double = clock(tmp_path, np.repeat(np.arange(50), 2) * 1e-3)
    assert double.recording["piston.pressure_1"].tolist() == list(range(0, 100, 2))
    holes = np.arange(100) * 1e-3
    holes[3] = np.nan
    missing = clock(tmp_path, holes)
    assert len(missing.recording.time) == 99
    for reading in (back, double, missing):
        assert kinds(reading) == [("time", "clock", "repaired")]


def test_a_column_map(tmp_path: Path) -> None:
    names = file(
        tmp_path,
        '[file]\nheader = false\n[columns]\n"1" = "time [ms]"\n'
        '"3" = { column = "piston.pressure_1 [bar]", offset = 1.01325 }\n"2" = "slide.position [mm]"\n',
        "map.toml",
    )
    recording = read(file(tmp_path, numbered(30, "{i}\t{i}\t{i}\t{i}\n")), names).recording
    np.testing.assert_allclose(recording["piston.pressure_1"], 1e5 * np.arange(30) + 101325.0)
    np.testing.assert_allclose(recording["slide.position"], 1e-3 * np.arange(30))


@pytest.mark.parametrize(
    "text,says",
    [
        ("[columns", "TOML"),
        ("", r"no \[columns\]"),
        ('[column]\n"a" = "time [s]"\n', 'did you mean "columns"'),
        ('[columns]\n"a" = 3\n', "write the column it is"),
        ('[columns]\n"a" = "p.presure_1 [Pa]"\n', "pressure_1"),
        ('[columns]\n"a" = "p.pressure_1 [psig]"\n', "gauge"),
        ('[columns]\n"a" = { column = "p.pressure_1 [Pa]", scale = "x" }\n', "must be numbers"),
        ('[columns]\n"a" = { column = "p.pressure_1 [Pa]", scale = 1e300 }\n', r"numbers of less than 1e\+30"),
        ('[columns]\n"a" = { colum = "p.pressure_1 [Pa]" }\n', "did you mean"),
        ('[columns]\n"nowhere" = "time [s]"\n', 'column "nowhere"'),
        ('[file]\ndelimiter = ";;"\n[columns]\n"time [s]" = "time [s]"\n', "one character"),
    ],
)
def test_a_column_map_that_cannot_be(tmp_path: Path, text: str, says: str) -> None:
    names = file(tmp_path, text, "map.toml")
    with pytest.raises(ExoSimError, match=says) as caught:
        read(file(tmp_path, HEADING + BODY), names)
    assert "\n" not in str(caught.value)


def test_a_billion_rows_are_refused_before_they_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "long.csv"
    with path.open("wb") as out:
        out.write((HEADING + BODY * 20000).encode())
        out.truncate(20_000_000_000)  # sparse: takes no room on the disk
    with pytest.raises(RecordingError, match="would take"):
        read(path)
    short = tmp_path / "short.parquet"
    parquet.write_table(pa.table({"time [s]": np.arange(1000.0), "p.pressure_1 [Pa]": np.arange(1000.0)}), short)
    monkeypatch.setattr(column_selection, "MOST_BYTES", 10_000)
    with pytest.raises(RecordingError, match="cut it into pieces"):
        read(short)


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    text=st.one_of(
        st.binary(max_size=300),
        st.text(alphabet='0123456789.,;\t\n-+eE[]"# aPst_', max_size=300).map(lambda s: s.encode()),
        st.text(alphabet="0123456789.,;\n-enif#", max_size=400).map(lambda s: (HEADING + s).encode()),
    ),
    ending=st.sampled_from(["csv", "parquet", "rrd"]),
)
def test_no_file_ends_in_a_traceback(tmp_path: Path, text: bytes, ending: str) -> None:
    path = file(tmp_path, text, f"any.{ending}")
    try:
        reading = read(path)
    except ExoSimError as error:
        assert "\n" not in str(error)
    else:
        assert (np.diff(reading.recording.time) > 0).all()
        check(reading.recording)


@pytest.mark.parametrize("clock", ["t", "Time (s)", "log.time", "timestamp", "t(ms)", "tme [s]", "Timestmp"])
def test_a_clock_of_another_name_is_offered_as_a_line_of_a_column_map(tmp_path: Path, clock: str) -> None:
    path = tmp_path / "lab.csv"
    path.write_text(f"torque,{clock},P1\n" + "".join(f"0,{0.01 * i},3.0\n" for i in range(20)))
    with pytest.raises(RecordingError, match=rf'with the line "{re.escape(clock)}" = "time \[s\]"; there is: "torque", '):
        read(path)


def test_where_no_column_is_a_signal_the_columns_are_listed(tmp_path: Path) -> None:
    path = tmp_path / "lab.csv"
    path.write_text("time [s],P1,stamp\n" + "".join(f"{0.01 * i},3.0,1\n" for i in range(20)))
    with pytest.raises(RecordingError, match=r'no signal beside the time; .*column map; there is: "time \[s\]", "P1", "stamp"'):
        read(path)


def test_a_folder_is_refused_with_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="it is a folder, not a file; name a file in it"):
        read(tmp_path)


def test_a_question_in_a_finding_ends_its_sentence(tmp_path: Path) -> None:
    found = read(file(tmp_path, HEADING.replace("\n", ",p.presure_2 [Pa]\n") + BODY.replace("\n", ",1\n"))).findings
    assert [one.says.endswith('did you mean "pressure_2" or "pressure_1"? The column was set aside') for one in found] == [True]


@pytest.mark.parametrize("unit", ["s", "ms", "us", "ns"])
@pytest.mark.parametrize("kind", [pa.timestamp, pa.duration], ids=["timestamps", "durations"])
def test_a_parquet_clock_may_be_of_timestamps_or_durations(tmp_path: Path, kind: Callable[[str], pa.DataType], unit: str) -> None:
    ticks = {"s": 1, "ms": 1000, "us": 1_000_000, "ns": 1_000_000_000}[unit]
    begun = 1_700_000_000 if kind is pa.timestamp else 0
    time = pa.array([(begun + i) * ticks for i in range(20)], pa.int64()).cast(kind(unit))
    parquet.write_table(pa.table({"time [s]": time, "p.pressure_1 [Pa]": [1e5 + i for i in range(20)]}), tmp_path / "bench.parquet")
    np.testing.assert_allclose(read(tmp_path / "bench.parquet").recording.time, np.arange(20.0), rtol=1e-15, atol=0.0)
