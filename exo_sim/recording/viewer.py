"""Opening the rerun viewer's window."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from exo_sim.errors import OutputError
from exo_sim.recording.reader import read
from exo_sim.recording.rrd_file import write_rrd
from exo_sim.recording.rrd_table import check_whole


@contextmanager
def as_rrd(path: Path, column_map: Path | None = None, keep: bool = False) -> Iterator[Path]:
    """Give an .rrd of any recording: itself, or one made of the table for as long as the block lasts.

    Args:
        path: The recording.
        column_map: For foreign names.
        keep: Leave the made one in the system's folder for passing files: a window outlives the block.

    Raises:
        RecordingError: it cannot be read.
    """
    if path.suffix.lower() == ".rrd":
        check_whole(path)
        yield path
        return
    recording = read(path, column_map).recording
    folder = Path(tempfile.mkdtemp(prefix="exo-sim-"))
    made = folder / f"{path.stem}.rrd"
    write_rrd(made, recording)
    try:
        yield made
    except BaseException:
        keep = False
        raise
    finally:
        if not keep:
            made.unlink(missing_ok=True)
            folder.rmdir()


def open_window(rrd: Path) -> None:
    """Start the viewer on a recording and return at once.

    Raises:
        OutputError: there is no display, or the viewer does not start.
    """
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise OutputError(
            "there is no display here to open a window on; take a picture with --out PICTURE.png, "
            f'or copy "{rrd.name}" to a machine that has one and run: rerun {rrd.name}'
        )
    try:
        viewer = subprocess.Popen(
            [sys.executable, "-m", "rerun", "--bind", "127.0.0.1", str(rrd.resolve())],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        status = viewer.wait(
            timeout=1.0
        )  # one that cannot paint ends at once; one that hands over to another ends well
    except subprocess.TimeoutExpired:
        return
    except OSError as error:
        raise OutputError(f"cannot start the rerun viewer: {error.strerror or error}") from None
    if status:
        raise OutputError(f"the rerun viewer ended at once with status {status}; take a picture with --out PICTURE.png")
