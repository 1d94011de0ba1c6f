"""The learnt policy beside the built-in causal control, over strides that are neither the learnt nor the calibrated one."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

from exo_sim.control import user_controller
from exo_sim.control.causal import Causal
from exo_sim.rig import Rig
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.walk import Request
from exo_sim.simulation.worn import Simulation
from walking_tables.disturbances import CASES, PAYLOAD, Case

STRIDES = 6
JOINTS = ("hip", "knee", "ankle")
HEADING = "Over strides that are not the one learnt on"


def _walked(exo: Rig, case: Case, controller: user_controller.Controller | None, nominal: Simulation | None) -> dict[str, Any]:
    """Walk with somebody's controller, or with causal control calibrated on a nominal stride; return the summary."""
    rig = exo if case.wearer is None else dataclasses.replace(exo, wearer=case.wearer)
    request = Request(
        "level_walk", PAYLOAD + case.payload, speed=case.speed, cycles=STRIDES, law="inverse_dynamics", variation=case.variation,
        driven="" if controller is None else "valves",
    )  # fmt: skip
    simulation = Simulation(rig, request, controller)
    simulation.straps = simulation.straps.stiffened(case.stiffness)
    if nominal is not None:
        assert nominal.calibration is not None
        simulation.controlled_by(Causal(nominal.calibration), seed=1)
    return summarise(simulation.run())


def section(exo: Rig, policy: Path) -> str:
    """Return the page's section: extra moments of both over every change but those of a phase that the policy does not estimate."""
    nominal = Simulation(exo, Request("level_walk", PAYLOAD, cycles=STRIDES, law="causal"))
    lines = [
        f"## {HEADING}", "",
        f"`scripts/learn_policy --disturbances` walks {STRIDES} strides of each with what was learnt and with the built-in",
        "causal control (`--demand causal`). Extra moments that the machine imposes on the wearer, N m rms, learnt / causal;",
        "the backpack's beside them.", "",
        "| strides | hip | knee | ankle | backpack hip / knee / ankle |", "| --- | --- | --- | --- | --- |",
    ]  # fmt: skip
    wins = 0
    cases = {name: case for name, case in CASES.items() if case.late == case.wrong == 0.0 and case.wearer is None}
    for name, case in cases.items():
        learnt = _walked(exo, case, user_controller.load(f"{policy}:LearntPolicy"), None)["wearer"]
        built_in = _walked(exo, case, None, nominal)["wearer"]
        pairs = [(learnt["extra_moment_rms_nm"][joint], built_in["extra_moment_rms_nm"][joint]) for joint in JOINTS]
        wins += sum(one < other for one, other in pairs)
        pack = " / ".join(f"{learnt['backpack_moment_rms_nm'][joint]:.0f}" for joint in JOINTS)
        lines.append(f"| {name} | {' | '.join(f'{one:.1f} / {other:.1f}' for one, other in pairs)} | {pack} |")
        print(lines[-1], flush=True)
    lines += [
        "", f"Of {3 * len(cases)} moments the learnt policy's is the smaller in {wins}. It sees the true phase of the stride;",
        "causal control estimates it, and hears the straps through noise. What was learnt was learnt on the reference stride until commit",
        "5cd751e; causal control is calibrated on that of today.",
    ]  # fmt: skip
    return "\n".join(lines)
