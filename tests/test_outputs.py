from __future__ import annotations

import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest

from exo_sim.errors import OutputError
from exo_sim.outputs import alone_in, check_writable, replacing, replacing_all


def test_the_result_takes_its_place_when_the_block_ends_well(tmp_path: Path) -> None:
    target = tmp_path / "deep" / "walk.rrd"
    with replacing(target) as beside:
        assert beside.suffix == ".rrd"
        beside.write_text("new")
        assert not target.exists()
    assert target.read_text() == "new"
    assert list(target.parent.iterdir()) == [target]


@pytest.mark.parametrize("ending", [ValueError, KeyboardInterrupt])
def test_an_error_or_interrupt_leaves_what_was_there(tmp_path: Path, ending: type[BaseException]) -> None:
    target = tmp_path / "walk.txt"
    target.write_text("old")
    with pytest.raises(ending), replacing(target) as beside:
        beside.write_text("ne")
        raise ending
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_a_full_disk_is_one_line_and_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="the disk is full") as caught, replacing(tmp_path / "walk.txt") as beside:
        beside.write_text("half")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_device_is_written_straight_and_may_be_full() -> None:
    with pytest.raises(OutputError, match='"/dev/full": the disk is full'), replacing("/dev/full") as straight:
        assert straight == Path("/dev/full")
        straight.write_text("more than it holds")


def test_a_folder_or_a_file_in_the_way_is_named(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="it is a folder"), replacing(tmp_path):
        pass
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot write"), replacing(tmp_path / "file" / "walk.rrd"):
        pass


def test_a_link_keeps_pointing_where_it_points(tmp_path: Path) -> None:
    (tmp_path / "real.txt").write_text("old")
    (tmp_path / "link.txt").symlink_to("real.txt")
    with replacing(tmp_path / "link.txt") as beside:
        beside.write_text("new")
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "real.txt").read_text() == "new"


def test_an_input_that_cannot_be_read_is_not_blamed_on_the_output(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError), replacing(tmp_path / "out.txt"):
        (tmp_path / "absent.txt").read_text()


def dead_process() -> int:
    """Return the number of a process that has ended."""
    child = subprocess.Popen([sys.executable, "-c", ""])
    child.wait()
    return child.pid


def test_what_a_killed_process_left_of_the_same_file_is_taken_away(tmp_path: Path) -> None:
    code = (
        "import os, signal, sys\nfrom exo_sim.outputs import replacing\n"
        "with replacing(sys.argv[1]) as beside:\n    beside.write_text('half')\n    os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    subprocess.run([sys.executable, "-c", code, str(tmp_path / "walk.rrd")], check=False)
    (tmp_path / f".walk.{dead_process()}.partial.rrd").write_text("of an older version")
    assert len(list(tmp_path.iterdir())) == 2
    with replacing(tmp_path / "walk.rrd") as beside:
        beside.write_text("whole")
    assert [path.name for path in tmp_path.iterdir()] == ["walk.rrd"]


def test_what_living_processes_other_machines_and_strangers_have_there_stays(tmp_path: Path) -> None:
    dead = dead_process()
    others = [f".walk.{os.getppid()}.partial.rrd", f".walk.{dead}@elsewhere.partial.rrd", f".run.{dead}.partial.rrd",
              f".walk.{dead}.partial.csv", f"walk.{dead}.partial.rrd", f".walk.{dead}x.partial.rrd"]  # fmt: skip
    for name in others:
        (tmp_path / name).write_text("mine")
    with replacing(tmp_path / "walk.rrd") as beside:
        beside.write_text("whole")
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([*others, "walk.rrd"])


def test_a_name_as_long_as_the_file_system_allows_can_be_written(tmp_path: Path) -> None:
    target = tmp_path / ("w" * 251 + ".rrd")
    with replacing(target) as beside:
        beside.write_text("new")
    assert target.read_text() == "new"


def test_files_that_belong_together_appear_together(tmp_path: Path) -> None:
    with replacing_all(tmp_path / "a.rrd", tmp_path / "a.parquet") as (first, second):
        first.write_text("1")
        second.write_text("2")
        assert not (tmp_path / "a.rrd").exists()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.parquet", "a.rrd"]


@pytest.mark.parametrize("before", [None, "old"])
def test_files_that_belong_together_appear_not_at_all_where_one_cannot(
    tmp_path: Path, before: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = ("a.rrd", "a.parquet")
    for name in names if before else ():
        (tmp_path / name).write_text("old")
    real = Path.replace

    def refused(self: Path, target: Path) -> Path:
        if self.suffix == ".parquet" and ".partial" in self.name:
            raise OSError(errno.EIO, os.strerror(errno.EIO), str(self))
        return real(self, target)

    monkeypatch.setattr(Path, "replace", refused)
    with pytest.raises(OutputError, match=r"a\.parquet"), replacing_all(*(tmp_path / name for name in names)) as besides:
        for beside in besides:
            beside.write_text("new")
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == (dict.fromkeys(names, "old") if before else {})


def test_a_folder_that_cannot_be_written_is_found_out_at_once(tmp_path: Path) -> None:
    check_writable(tmp_path / "new" / "folder")
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "file").write_text("")
    for wrong in (tmp_path / "file", tmp_path / "file" / "below", Path("/proc/nothing")):
        with pytest.raises(OutputError, match="cannot write"):
            check_writable(wrong)


def test_two_that_do_the_same_in_one_folder_do_not_meet(tmp_path: Path) -> None:
    code = (
        "import sys\nfrom pathlib import Path\nfrom exo_sim.outputs import alone_in\n"
        "with alone_in(Path(sys.argv[1]), 'size'):\n    print('in', flush=True)\n    sys.stdin.read()\n"
    )
    other = subprocess.Popen([sys.executable, "-c", code, str(tmp_path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert other.stdout is not None and other.stdout.readline() == b"in\n"
    with pytest.raises(OutputError, match="another size is at work"), alone_in(tmp_path, "size"):
        pass
    other.kill()
    other.communicate()
    with alone_in(tmp_path, "size"):
        pass
    assert list(tmp_path.iterdir()) == []
