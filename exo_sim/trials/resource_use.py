"""Running a command and saying what it took."""

from __future__ import annotations

import math
import resource
import signal
import subprocess
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from exo_sim.errors import TrialError
from exo_sim.trials.tool import STOPPED, WORDS, end_group, end_of, wait


def used_by(line: Sequence[str], folder: Path, env: Mapping[str, str], timeout: float) -> tuple[int, str, resource.struct_rusage]:
    """Run a command in a folder; what it started and left running is ended with it.

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
    with (folder / WORDS).open("w+b") as said:
        try:
            process = subprocess.Popen(
                line, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=said, env=dict(env), start_new_session=True
            )
        except (OSError, ValueError) as error:
            raise TrialError(f'cannot run "{line[0]}": {getattr(error, "strerror", None) or error}') from None
        try:
            if hasattr(resource, "prlimit"):
                resource.prlimit(process.pid, resource.RLIMIT_CPU, (math.ceil(timeout), math.ceil(timeout) + 5))
            status, used = wait(process, time.monotonic() + 10.0 * timeout)
        finally:
            end_group(process)
        return (STOPPED if status == -signal.SIGXCPU else status), end_of(said), used
