"""Running a command and saying what it took."""

from __future__ import annotations

import math
import os
import resource
import signal
import subprocess
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from exo_sim.errors import TrialError


def used_by(line: Sequence[str], folder: Path, env: Mapping[str, str], timeout: float) -> tuple[int, str, resource.struct_rusage]:
    """Run a command in a folder.

    Args:
        line: The command and its arguments.
        folder: Where it is started.
        env: Its environment.
        timeout: Processor seconds after which it is stopped, or ten times as many by the clock: others share the machine.

    Returns:
        Its exit status (-1 where it had to be stopped), the end of what it said on stderr, and what it used.

    Raises:
        TrialError: the command cannot be started.
    """
    with (folder / "words").open("w+") as words:
        try:
            process = subprocess.Popen(line, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=words, env=dict(env))
        except OSError as error:
            raise TrialError(f'cannot run "{line[0]}": {error.strerror}') from None
        if hasattr(resource, "prlimit"):
            resource.prlimit(process.pid, resource.RLIMIT_CPU, (math.ceil(timeout), math.ceil(timeout) + 5))
        deadline = time.monotonic() + 10.0 * timeout
        stopped = False
        while True:
            pid, status, used = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            if time.monotonic() > deadline and not stopped:
                os.kill(process.pid, signal.SIGKILL)  # Popen.kill may reap the process, and what it used would be lost
                stopped = True
            time.sleep(0.02)
        process.returncode = os.waitstatus_to_exitcode(status)
        words.seek(0)
        stopped = stopped or process.returncode == -signal.SIGXCPU
        return (-1 if stopped else process.returncode), words.read().strip()[-500:], used
