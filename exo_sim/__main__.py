"""`python -m exo_sim VERB`, and the command `exo-sim`."""

from __future__ import annotations

import gc
import os
import signal
import sys

#: New objects after which the interpreter looks for circles among them, and how many such looks make a longer one: what a verb loads is
#: half a million objects that stay, and to look through all of them takes a twentieth of a second.
_COLLECTED_EVERY = 20_000, 10, 100


def start() -> int:
    """Run the verb of this process's command line and return its exit status.

    Ctrl-C ends the process without a word while the program is loaded and while the interpreter shuts down: no handler of ours stands
    there, and Python's would print a traceback. In a process that was started with interrupts ignored they stay so.
    """
    ours = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if ours:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    gc.set_threshold(*_COLLECTED_EVERY)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # what `exo_sim.linear_algebra` does, for what is loaded later as well
    from exo_sim.cli import main

    if ours:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        return main()
    finally:
        if ours:
            signal.signal(signal.SIGINT, signal.SIG_DFL)


if __name__ == "__main__":
    sys.exit(start())
