"""What holds machine code: old versions go, nothing else does, and nobody else's code is run."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from exo_sim.physics import compiled_cache


@pytest.fixture(params=["EXO_SIM_CACHE", "XDG_CACHE_HOME"])
def cache(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.delenv("EXO_SIM_CACHE", raising=False)
    monkeypatch.setenv(request.param, str(tmp_path))
    return tmp_path


def key(number: int) -> str:
    return f"{number:016x}"


def old(path: Path, age: float) -> None:
    os.utime(path, (1e9 - age, 1e9 - age))


def test_a_checkout_of_that_name_loses_nothing(cache: Path) -> None:
    """It was emptied but for its newest four entries."""
    names = (".git", "docs", "tests", "exo_sim", "assets", "scripts", "0123456789abcdef", "machine-code/0123456789abcdee")
    for number, name in enumerate(names):
        entry = cache / "exo-sim" / name
        entry.mkdir(parents=True)
        (entry / "work.txt").write_text("mine")
        old(entry, 1000.0 + number)
    for number in range(8):
        assert compiled_cache.folder(key(number)) is not None
    assert all((cache / "exo-sim" / name / "work.txt").read_text() == "mine" for name in names)


def test_old_versions_go_and_take_nothing_foreign_along(cache: Path) -> None:
    for number in range(7):
        place = compiled_cache.folder(key(number))
        assert place is not None
        (place / "module_1").mkdir()
        (place / "module_1" / "f.nbi").write_text("")
        (place / "module_1" / "f.1.nbc").write_text("")
        if number == 0:
            (place / "notes.txt").write_text("mine")
        old(place, 100.0 - number)
    place = compiled_cache.folder(key(7))
    assert place is not None
    left = {path.name for path in place.parent.iterdir()}
    assert left == {key(0), key(4), key(5), key(6), key(7)}
    assert (place.parent / key(0) / "notes.txt").read_text() == "mine"
    assert not list((place.parent / key(0)).rglob("*.nb?"))


def test_a_link_is_not_followed(cache: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    (elsewhere / compiled_cache.MARK).touch()
    (elsewhere / "f.nbc").write_text("mine")
    assert compiled_cache.folder(key(99)) is not None
    (compiled_cache.root() / key(98)).symlink_to(elsewhere)
    old(elsewhere, 1e6)
    for number in range(6):
        compiled_cache.folder(key(number))
    assert (elsewhere / "f.nbc").exists()


@pytest.mark.parametrize(("mode", "which"), [(0o777, 0), (0o770, 0), (0o777, 1), (0o775, 2)])
def test_code_that_others_could_have_put_there_is_not_used(cache: Path, mode: int, which: int) -> None:
    place = compiled_cache.folder(key(1))
    assert place is not None
    (place, *place.parents)[which].chmod(mode)
    with pytest.warns(UserWarning, match="can be written by others"):
        assert compiled_cache.folder(key(1)) is None


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root can give a folder away")
def test_a_folder_of_another_user_is_not_used(cache: Path) -> None:
    place = compiled_cache.folder(key(1))
    assert place is not None
    os.chown(place, 12345, 12345)
    with pytest.warns(UserWarning, match="can be written by others"):
        assert compiled_cache.folder(key(1)) is None


def test_the_command_says_so_in_one_line_and_works(tmp_path: Path) -> None:
    made = tmp_path / "exo-sim"
    made.mkdir()
    made.chmod(0o777)
    done = subprocess.run(
        [sys.executable, "-m", "exo_sim", "effects", "wall_heat_transfer", "--json"], capture_output=True, text=True, check=False,
        env={**os.environ, "EXO_SIM_CACHE": str(tmp_path)},
    )  # fmt: skip
    assert done.returncode == 0 and done.stdout.startswith("{")
    assert done.stderr.startswith("exo-sim: ") and done.stderr.count("\n") == 1
    assert "can be written by others" in done.stderr
    assert list(made.rglob("*.nb?")) == []


def test_a_folder_that_cannot_be_made_costs_only_the_keeping(cache: Path) -> None:
    (cache / "exo-sim").write_text("a file")
    assert compiled_cache.folder(key(1)) is None
