"""Walking with the best designs as `exo-sim run` does: its own demand, rehearsed with the design's own gas.

The search asks for the torques of inverse dynamics, which no design changes. What `exo-sim run` asks for is bettered by rehearsal
with the cylinders that are there, so it costs a second a design and is asked of the best few only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from exo_sim.errors import ExoSimError
from exo_sim.rig import Rig
from exo_sim.simulation import summary
from exo_sim.simulation.walk import Request, Walk
from exo_sim.simulation.worn import Simulation
from exo_sim.sizing.disturbances import Disturbance, disturbances_of, disturbed
from exo_sim.sizing.loads import Condition

#: Cycles that are walked; what `summary` leaves out at the start does not count.
CYCLES = 4


@dataclass(frozen=True)
class Confirmed:
    """What one design did.

    Attributes:
        walk: The run, or None where it failed.
        summary: Its numbers as `exo-sim run --json` gives them.
        error: Largest rms over the sized joints of torque less torque demanded [N m].
        peak: Largest pressure in any chamber, absolute [Pa].
        trouble: Why it failed, or "".
    """

    walk: Walk | None
    summary: dict[str, Any]
    error: float
    peak: float
    trouble: str = ""

    @property
    def gas(self) -> float:
        """Drawn a cycle [kg], infinite where the run failed."""
        return float(self.summary["gas"]["mass_kg_per_stride"]) if "gas" in self.summary else float("inf")

    def excess(self, most_error: float, most_pressure: float) -> float:
        """Return how far it goes beyond its limits: at most 1 keeps to both."""
        return max(self.error / most_error, self.peak / most_pressure)


def confirm(rig: Rig, condition: Condition, joints: tuple[str, ...]) -> Confirmed:
    """Walk with a fitted rig.

    Args:
        rig: The machine with a design's cylinders, or read from `sized.toml`.
        condition: What it does.
        joints: Those that were sized.

    Raises:
        KeyboardInterrupt: Ctrl-C.
    """
    return _walked(lambda: _simulation(rig, condition), joints)


def confirm_disturbed(rig: Rig, condition: Condition, joints: tuple[str, ...]) -> Iterator[tuple[Disturbance, Confirmed]]:
    """Walk with a fitted rig under each disturbance of a condition, as long as they are asked for; arguments as of `confirm`.

    Raises:
        ExoSimError: it does not walk undisturbed.
        KeyboardInterrupt: Ctrl-C.
    """
    if not disturbances_of(condition):
        return
    for one, simulation in disturbed(_simulation(rig, condition), rig, condition):
        yield one, _walked(lambda simulation=simulation: simulation, joints)  # type: ignore[misc]


def _simulation(rig: Rig, condition: Condition) -> Simulation:
    return Simulation(condition.worn(rig), Request(condition.scenario, condition.payload, condition.speed, CYCLES))


def _walked(made: Callable[[], Simulation], joints: tuple[str, ...]) -> Confirmed:
    try:
        walk = made().run()
    except ExoSimError as error:
        return Confirmed(None, {}, float("inf"), float("inf"), str(error))
    if walk.interrupted:
        raise KeyboardInterrupt("finished designs are kept; the same command goes on from there")
    found = summary.summarise(walk)
    return Confirmed(
        walk,
        found,
        error=max(found["joints"][joint]["torque_error_rms_nm"] for joint in joints),
        peak=max(one["pressure_peak_pa"] for one in found["cylinders"].values()),
    )
