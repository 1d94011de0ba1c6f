"""`exo.size`: actuators against joint loads."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

from exo_sim.api.arguments import Quantity, RecordingLike, RigLike, quantity, reading_of, rig_of
from exo_sim.api.result_folder import result_folder
from exo_sim.api.rig import Rig
from exo_sim.api.sizing_result import SizingResult
from exo_sim.errors import ScenarioError, nearest
from exo_sim.rig import Rig as Machine
from exo_sim.sizing import summary_text
from exo_sim.sizing.design_space import Space
from exo_sim.sizing.loads import Condition, JointLoads, joint_loads
from exo_sim.sizing.study import Sizing as Study

if TYPE_CHECKING:
    from exo_sim.api.motion_sizing import MotionSizing


#: Designs to look at where nobody says how many: of a worn machine, and along a motion.
TRIALS, MOTION_TRIALS = 800, 100
#: The valves that are sized: the rig's, or those with edges of their own for each chamber.
VALVES = ("rig", "independent")


@dataclass(frozen=True, repr=False)
class Sizing(SizingResult[Study]):
    """The result of a search for actuators of a worn machine; `study` is a `exo_sim.sizing.study.Sizing`."""

    _columns = (*SizingResult._columns, "torque_error_rms_nm")

    @property
    def summary(self) -> dict[str, Any]:
        """Return what `exo-sim size --json` prints."""
        return summary_text.numbers(self.study, self.folder)

    def __str__(self) -> str:
        return summary_text.words(self.study, self.folder)


@dataclass(frozen=True)
class Question:
    """What a search is asked: the machine, what it must do, what it asks of its joints, and what may be chosen."""

    machine: Machine
    conditions: tuple[Condition, ...]
    loads: tuple[JointLoads, ...]
    space: Space


def question(
    rig: RigLike | None = None, *, scenarios: str | Sequence[str] = "level_walk", payloads: Quantity | Sequence[Quantity] = 34.0,
    speeds: float | Sequence[float] = 1.0, reach: Quantity = 0.04, pressure_limit: Quantity | None = None, joints: str | Sequence[str] = (),
    catalogue: str | os.PathLike[str] | None = None, fix: Mapping[str, Quantity] | Sequence[str] = (), travel: str = "joint",
    springs: bool = False, own_mass: bool = False, heights: Quantity | Sequence[Quantity] = (), robust: bool = False,
    valves: str = "rig", tank: Quantity | None = None,
) -> Question:  # fmt: skip
    """Return what a search is asked; arguments and errors as of `size`."""
    from exo_sim.rig.own_catalogue import find_catalogue, read_catalogue
    from exo_sim.rig.valve import with_edges, with_tank
    from exo_sim.sizing.fixed_numbers import given_numbers
    from exo_sim.sizing.own_mass import carried
    from exo_sim.sizing.robust_conditions import around
    from exo_sim.sizing.study import space_of
    from exo_sim.sizing.travel import TRAVELS, within_tasks

    if valves not in VALVES:
        raise ScenarioError(f'valves "{valves}"{nearest(valves, VALVES)}')
    if travel not in TRAVELS:
        raise ScenarioError(f'travel "{travel}"{nearest(travel, TRAVELS)}')
    machine: Machine = rig_of(Rig.included("exo_250_psi") if rig is None else rig)  # its frame carries no cylinder yet
    masses = [quantity(one, "kg", "payload", low=0.0) for one in _several(payloads)]
    wearers: list[float | None] = [quantity(one, "m", "heights", low=0.5, high=3.0) for one in _several(heights)]
    wearers = wearers or [None]
    conditions = tuple(dict.fromkeys(Condition(*each) for each in product(_several(scenarios), masses, _several(speeds), wearers)))
    if robust:
        conditions = around(conditions)
    if valves == "independent":
        machine = with_edges(machine)
    if tank is not None:
        machine = with_tank(machine, quantity(tank, "m^3", "tank", low=0.0, high=1.0))
    limit = None if pressure_limit is None else quantity(pressure_limit, "Pa", "pressure_limit", low=0.0)
    fixed, bought = given_numbers(fix), None if catalogue is None else read_catalogue(find_catalogue(catalogue))
    loads = tuple(joint_loads(machine, condition) for condition in conditions)
    if travel == "task":
        machine = within_tasks(machine, loads)
    space = space_of(machine, quantity(reach, "m", "reach", 0.0, 0.2), limit, tuple(_several(joints)), bought, fixed, springs)
    if own_mass:
        machine = carried(machine, space, conditions, loads)
        loads = tuple(joint_loads(machine, condition) for condition in conditions)
    return Question(machine, conditions, loads, space)


def size(
    rig: RigLike | None = None, *, motion: RecordingLike | None = None, scenarios: str | Sequence[str] = "level_walk",
    payloads: Quantity | Sequence[Quantity] = 34.0, speeds: float | Sequence[float] = 1.0, trials: int | None = None,
    reach: Quantity = 0.04, pressure_limit: Quantity | None = None,
    joints: str | Sequence[str] = (), catalogue: str | os.PathLike[str] | None = None,
    fix: Mapping[str, Quantity] | Sequence[str] = (), travel: str = "joint", springs: bool = False,
    own_mass: bool = False, heights: Quantity | Sequence[Quantity] = (), robust: bool = False, valves: str = "rig",
    tank: Quantity | None = None, jobs: int = -1, scheduler: str | None = None, seed: int = 0,
    out: str | os.PathLike[str] | None = None, quiet: bool = True,
    tell: Callable[[str], None] = lambda words: None,
) -> Sizing | MotionSizing:  # fmt: skip
    """Search bores, rods, strokes, attachment points, valves and supply against the joint loads of what the machine must do.

    Args:
        rig: A path or `exo.Rig` of a worn machine, with what a diagnosis found of it; `exo_250_psi`, whose frame carries no cylinder yet,
            when None.
        motion: For a machine that nobody wears: a recording with the positions of its joints and, where there are any, the forces from
            outside. Then attachment points stay, and scenarios, payloads, speeds, reach, travel, springs, heights, robust,
            valves, tank, jobs and scheduler do not count.
        scenarios: What the machine must do, one or several; every combination with payloads and speeds must be carried.
        payloads: On the back, one or several: kilograms, or text.
        speeds: Factors on the recorded cadence, one or several.
        trials: Designs to look at; 800, or 100 along a motion, when None.
        reach: How far an attachment point may move: metres, or text.
        pressure_limit: Largest pressure of supply and chambers, absolute: pascal, or text; when None, 10 bar above the atmosphere.
        joints: Those to size, like ("knee_l", "knee_r"); all that have cylinders when empty.
        catalogue: TOML file with [[cylinder]] and [[valve]] to choose from, or the name of a maker's that comes along ("smc", "festo");
            the standards' when None.
        fix: What is not to be chosen, like {"supply": "7 bar", "hip.bore": "40 mm"}; SI numbers or text, or texts like "supply=7 bar".
        travel: "joint": strokes cover the joints' whole range; "task": what is asked for, and 10 degrees more each way, with stops there.
        springs: Whether a spring may stand beside each rod; for valves with independent edges.
        heights: Of wearers, one or several, every combination with the rest: metres, or text; the rig's own when empty.
        robust: Whether a short, a tall and an unladen wearer at other cadences count as well (`sizing.around`),
            and the recommended design must stand disturbances of the walk (`sizing.disturbances`).
        valves: "rig", or "independent": each chamber's edges have a command of their own, and both pressures are planned.
        tank: Volume of a recovery tank whose pressure is chosen, m^3 or text, for independent edges; the rig's own when None, 0 for none.
        own_mass: Whether the bodies carry the cylinders' own mass, that of the smallest which suffice (`sizing.own_mass`).
        jobs: Processes; -1 is one a core.
        scheduler: Address of a Dask scheduler.
        seed: Where chance starts.
        out: Folder, which keeps finished designs: the same call goes on where it was interrupted. A temporary one when None.
        quiet: No progress.
        tell: Takes remarks.

    Raises:
        ScenarioError, RigError, ModelError: it cannot be carried out, or no design carries the loads.
    """
    from exo_sim.outputs import replacing
    from exo_sim.report.sizing_page import page
    from exo_sim.sizing.study import size as search
    from exo_sim.sizing.workers import Workers

    if jobs == 0:
        raise ScenarioError("jobs = 0: give a number of processes, or -1 for one a core")
    if motion is not None:
        from exo_sim.api.motion_sizing import size_motion

        return size_motion(
            rig, reading_of(motion).recording, trials=trials or MOTION_TRIALS, pressure_limit=pressure_limit,
            joints=tuple(_several(joints)), catalogue=catalogue, fix=fix, seed=seed, out=out, quiet=quiet,
        )  # fmt: skip
    asked = question(
        rig, scenarios=scenarios, payloads=payloads, speeds=speeds, reach=reach, pressure_limit=pressure_limit, joints=joints,
        catalogue=catalogue, fix=fix,
        travel=travel, springs=springs, own_mass=own_mass, heights=heights, robust=robust, valves=valves, tank=tank,
    )  # fmt: skip
    with result_folder(out, "size") as (folder, temporary):
        with Workers(jobs, scheduler) as workers:
            study = search(asked.machine, asked.conditions, asked.space, trials or TRIALS, seed, workers, folder, quiet, tell, robust)
        with replacing(folder / "report.html") as beside:
            beside.write_text(page(study), encoding="utf-8")
    return Sizing(study, folder, Rig.load(folder / "sized.toml"), temporary)


def _several(values: Any) -> list[Any]:
    return [values] if isinstance(values, int | float | str) else list(values)
