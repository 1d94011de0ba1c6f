"""Whatever is handed in as a text or as TOML, it is read or refused in a sentence; nothing hangs and nothing is computed."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from exo_sim.errors import ExoSimError, RecordingError, RigError
from exo_sim.inputs import MOST_TEXT, check_regular, json_value, refusing, text_of, toml
from exo_sim.recording.column_map import read_column_map
from exo_sim.rig import read

NESTED = "[" * 5000 + "]" * 5000
BAD_TOML = [f"a = {NESTED}", "a = " + "9" * 5000, "a = ", "a = 1\na = 2", "\x00", "a = 1e", "[a", "a = 9999-99-99", "= 1"]


@pytest.mark.parametrize("text", BAD_TOML)
def test_what_is_no_toml_is_one_sentence(text: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"TOML|nested|too many digits") as caught:
        toml(text)
    assert "\n" not in str(caught.value)
    path = tmp_path / "file.toml"
    path.write_text(text)
    with pytest.raises(RigError):
        read(path)
    with pytest.raises(RecordingError):
        read_column_map(path)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('a = 1\nb = "x\nc = 2\n', "is not TOML: a quote is not closed in line 2"),
        ("[a.b]\n[a.b]\n", r"is not TOML: cannot declare \[a\.b\] twice \(at line 2, column 5\)"),
        ("a = 'x\n", r"is not TOML: a single quote \('\) is not closed"),
    ],
)
def test_what_is_no_toml_is_said_in_its_own_terms(text: str, says: str) -> None:
    with pytest.raises(ValueError, match=f"^{says}$"):
        toml(text)


def test_devices_pipes_and_folders_are_refused_unread(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    save = "save it to a file"
    for path, remedy in ((tmp_path / "pipe", save), (tmp_path, "name a file in it"), (Path("/dev/zero"), save)):
        for reading in (check_regular, text_of):
            with pytest.raises(ValueError, match=f"not a file; {remedy}"):
                reading(path)
        for reader in (read, read_column_map):
            with pytest.raises(ExoSimError, match="not a file"):
                reader(path)


@pytest.mark.parametrize(
    ("raised", "said"),
    [(FileNotFoundError(2, "x"), "map: no such map"), (PermissionError(13, "Permission denied"), "map: cannot be read: Permission denied"),
     (ValueError("is not TOML"), "map: is not TOML"), (IsADirectoryError("odd"), "map: cannot be read: odd")],
)  # fmt: skip
def test_whatever_is_wrong_becomes_an_error_of_ones_own(raised: Exception, said: str) -> None:
    with pytest.raises(RecordingError) as error, refusing(lambda says: RecordingError(f"map: {says}"), "no such map"):
        raise raised
    assert str(error.value) == said


def test_errors_of_ones_own_pass() -> None:
    with pytest.raises(RigError, match="mine"), refusing(RecordingError):
        raise RigError("mine")


def test_a_text_that_is_too_large_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "large.toml"
    with path.open("wb") as file:
        file.truncate(MOST_TEXT + 1)
    with pytest.raises(ValueError, match="more than a text"):
        text_of(path)


def test_bytes_that_are_no_text_are_named(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_bytes(b'name = "\xff"')
    with pytest.raises(ValueError, match="byte 8 is 0xff"):
        text_of(tmp_path / "a.toml")


@pytest.mark.parametrize("model", ["/dev/zero", "a\\u0000b", "x" * 5000, "."])
def test_a_model_that_is_no_file_is_one_line(tmp_path: Path, model: str) -> None:
    (tmp_path / "rig.toml").write_text(f'model = "{model}"\n')
    with pytest.raises(RigError, match="no such MJCF file"):
        read(tmp_path / "rig.toml")


@pytest.mark.parametrize("text", ["a.b = [1, {}]", "a.b = {}", "a = [[{{b = {}}}]]"])
def test_a_number_beyond_64_bits_is_named(text: str) -> None:
    for digits in ("9" * 19, "-" + "9" * 400):
        with pytest.raises(ValueError, match=r"^a\.?b? is a number of too many digits: (19|400)$"):
            toml(text.format(digits))
    assert toml("a = 9223372036854775807") == {"a": 2**63 - 1}


@pytest.mark.parametrize("scale", ["1" + "0" * 400, "nan", "inf", "0", "true", "1e300"])
def test_a_scale_that_is_no_factor_is_refused(tmp_path: Path, scale: str) -> None:
    (tmp_path / "map.toml").write_text(f'[columns]\n"a" = {{ column = "p.pressure_1 [Pa]", scale = {scale} }}\n')
    with pytest.raises(RecordingError, match=r"scale and offset must be numbers|columns\.a\.scale is a number of too many digits: 401"):
        read_column_map(tmp_path / "map.toml")


def test_a_file_that_is_not_there_is_answered_with_its_neighbours(tmp_path: Path) -> None:
    (tmp_path / "bench.csv").write_text("")
    with pytest.raises(RecordingError, match=r'^there is no such file; did you mean "bench\.csv"\?$'), refusing(RecordingError):
        text_of(tmp_path / "benc.csv")


def test_what_json_says() -> None:
    assert json_value('{"a": [1, null]}') == {"a": [1, None]}


@pytest.mark.parametrize("text", ["{", b"\xff\xfe", "[" * 100_000, "1" * 5000])
def test_what_is_no_json_is_a_value_error(text: str | bytes) -> None:
    with pytest.raises(ValueError):
        json_value(text)


def test_the_mark_that_an_editor_puts_before_a_text_is_no_part_of_it(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_bytes(b"\xef\xbb\xbfa = 1\r\nb = 2\r\n")
    assert toml(text_of(tmp_path / "a.toml")) == {"a": 1, "b": 2}
    (tmp_path / "a.toml").write_bytes("a = 1".encode("utf-16"))
    with pytest.raises(ValueError, match="is UTF-16 text; save it as UTF-8"):
        text_of(tmp_path / "a.toml")
