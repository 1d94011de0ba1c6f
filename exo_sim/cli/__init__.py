"""The command `exo-sim VERB`: verbs only, no logic. One file a verb; it is imported when it is used."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Sequence

from exo_sim.cli import failures, interrupts, streams
from exo_sim.cli.frame import program
from exo_sim.errors import one_line


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one verb and return its exit status; errors become one line on stderr.

    Args:
        arguments: What stands behind `exo-sim`; the process's own arguments when absent.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *where: streams.say(f"exo-sim: {one_line(str(message))}")
        status = _run(words)
    streams.leave()
    return status


def _run(words: list[str]) -> int:
    os.environ.setdefault("RUST_LOG", "off")  # rerun's own log: what fails is said in our line
    with interrupts.noted() as interrupted:
        try:
            streams.prepare()
            if "_EXO_SIM_COMPLETE" in os.environ:
                program.main(words, prog_name="exo-sim")
            with program.make_context("exo-sim", words) as context:
                result = program.invoke(context)
            streams.flush()
        except BaseException as error:
            return failures.report(error, debug="--debug" in words, interrupted=interrupted())
    return result if isinstance(result, int) else 0
