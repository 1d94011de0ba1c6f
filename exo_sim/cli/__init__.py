"""The command `exo-sim VERB`: verbs only, no logic. One file a verb; it is imported when it is used."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from exo_sim.cli import failures
from exo_sim.cli.frame import program


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one verb and return its exit status; errors become one line on stderr.

    Args:
        arguments: What stands behind `exo-sim`; the process's own arguments when absent.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    os.environ.setdefault("RUST_LOG", "off")  # rerun's own log: what fails is said in our line
    if "_EXO_SIM_COMPLETE" in os.environ:
        program.main(words, prog_name="exo-sim")
    try:
        with program.make_context("exo-sim", words) as context:
            result = program.invoke(context)
        sys.stdout.flush()
    except BaseException as error:
        return failures.report(error, debug="--debug" in words)
    return result if isinstance(result, int) else 0
