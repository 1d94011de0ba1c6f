"""What a terminal shows while the first run compiles: it would be silent for a minute."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from exo_sim.progress import Stages

#: Machine code that every simulated machine needs.
_NEEDED = "*/coupled_step.*.nbi"


@contextmanager
def announced(quiet: bool) -> Iterator[Callable[[Callable[[], None]], None]]:
    """Print on a terminal that the simulation is compiled, where no machine code of it is kept; bars replace the line.

    Args:
        quiet: Print nothing.

    Yields:
        What prints other words meanwhile: it takes the line away, calls what it is given and puts the line back.
    """
    words = _words()
    with Stages(quiet or not words) as stages:
        stages.say(words)

        def aside(prints: Callable[[], None]) -> None:
            stages.close()
            prints()
            stages.say(words)

        yield aside


def _words() -> str:
    """Return what is to be said; "" where the code is there from an earlier start."""
    from numba.core import config

    import exo_sim.physics.compiled  # noqa: F401 - it says where machine code is kept

    kept = Path(config.CACHE_DIR) if config.CACHE_DIR else None  # type: ignore[attr-defined]
    if kept is not None and any(kept.glob(_NEEDED)):
        return ""
    return "compiling, once, about a minute" if kept is not None else "compiling, about a minute"
