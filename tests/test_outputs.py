from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from exo_sim.errors import OutputError
from exo_sim.outputs import replacing


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
