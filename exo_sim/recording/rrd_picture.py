"""A picture of an .rrd as the rerun viewer shows it, without a display.

Needs a Vulkan driver; on a machine without a graphics card a software one does (Debian: `mesa-vulkan-drivers
libvulkan1`).
"""

from __future__ import annotations

import contextlib
import os
import shlex
import socket
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from exo_sim.errors import OutputError, RecordingError, misspelt
from exo_sim.outputs import replacing


def take_picture(rrd: str | Path, png: str | Path, at: float | None = None, settle: float = 2.0) -> None:
    """Open a recording in a headless viewer and save what it shows.

    Args:
        rrd: The recording.
        png: Where to.
        at: Seconds on the recording's clock to show; wherever the viewer stands when None.
        settle: Seconds to wait for the viewer to load and paint.

    Raises:
        RecordingError: there is no such recording.
        OutputError: no viewer can be started here, or the picture cannot be written.
    """
    from rerun.experimental import ViewerClient

    rrd = Path(rrd)
    if not rrd.is_file():
        raise RecordingError(f'"{rrd}": there is no such recording{misspelt(rrd)}')
    try:
        with _quiet_surroundings() as folder:
            viewer = ViewerClient.spawn(
                headless=True, port=_free_port(), hide_welcome_screen=True, executable_path=_on_loopback(folder)
            )
    except Exception as error:  # rerun raises bare exceptions of many kinds
        raise OutputError(_no_viewer(error)) from None
    try:
        viewer.open(str(rrd.resolve()))
        time.sleep(settle)
        if at is not None:
            viewer.set_time("time", duration=at, play_state="paused")
            time.sleep(0.5 * settle)
        with replacing(png) as beside:
            beside.write_bytes(viewer.take_screenshot())
    except OutputError:
        raise
    except Exception as error:
        raise OutputError(_no_viewer(error)) from None
    finally:
        with contextlib.suppress(Exception):
            viewer.quit()


@contextlib.contextmanager
def _quiet_surroundings() -> Iterator[Path]:
    """Let the viewer's process start without its log, and with the folder that graphics libraries ask for; give the folder."""
    with tempfile.TemporaryDirectory(prefix="exo-sim-") as folder:
        wanted = {"RUST_LOG": "off", "XDG_RUNTIME_DIR": folder}
        added = [name for name in wanted if name not in os.environ]
        os.environ.update((name, wanted[name]) for name in added)
        try:
            yield Path(folder)
        finally:
            for name in added:
                del os.environ[name]


def _on_loopback(folder: Path) -> str | None:
    """Return a starter for the viewer that listens to this machine only and keeps to itself where in it it failed.

    Rerun's own way in has no word for either.
    """
    if os.name != "posix":
        return None
    starter = folder / "viewer"
    words = f'unset RERUN_APP_ONLY\nexec {shlex.quote(sys.executable)} -m rerun --bind 127.0.0.1 "$@" 2>/dev/null'
    starter.write_text(f"#!/bin/sh\n{words}\n", encoding="utf-8")
    starter.chmod(0o700)
    return str(starter)


def _no_viewer(error: Exception) -> str:
    why = str(error).splitlines()[0][:160] if str(error) else type(error).__name__
    driver = (
        "install a Vulkan driver (Debian: mesa-vulkan-drivers libvulkan1), or draw a stride of a walk with OpenGL alone: "
        "scripts/picture RECORDING PICTURE.png in a checkout"
    )
    if isinstance(error, (ConnectionError, TimeoutError)):
        return f"no picture: the rerun viewer did not answer ({why}); try again while the machine is less busy, {driver}"
    return f"no picture: the rerun viewer cannot paint here ({why}); {driver}"


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])
