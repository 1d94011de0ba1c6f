"""Strides that are not the calibrated one: the payload as a backpack, the rehearsed demand, and causal control beside each other."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from exo_sim.control.causal import Calibration, Causal
from exo_sim.gait.variation import Variation
from exo_sim.rig import Rig, Wearer
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.walk import Request
from exo_sim.simulation.worn import Simulation
from exo_sim.sizing.disturbances import late

PAYLOAD = 34.0
STRIDES = 12


@dataclasses.dataclass(frozen=True)
class Case:
    """One change.

    Attributes:
        late: How late the rehearsed demand comes, and how late the phase estimate is at the start, in strides.
        wrong: How late the phase is throughout that encoders give, in strides. The rehearsed demand comes as late.
        corrects: Whether strap forces correct the phase.
        stiffness: Of the straps, as a factor; damping grows with its root.
        payload: More than the calibration's [kg].
        speed: Factor on the cadence.
        variation: Of the strides.
        wearer: Who walks, None for the one of the calibration.
    """

    late: float = 0.0
    wrong: float = 0.0
    corrects: bool = True
    stiffness: float = 1.0
    payload: float = 0.0
    speed: float = 1.0
    variation: Variation | None = None
    wearer: Wearer | None = None


CASES = {
    "as calibrated": Case(),
    "begins 3 % late": Case(late=0.03),
    "begins 3 % early": Case(late=-0.03),
    "encoders' phase 3 % late throughout": Case(wrong=0.03),
    "encoders' phase 3 % early throughout": Case(wrong=-0.03),
    "the same, late, and straps do not correct it": Case(wrong=0.03, corrects=False),
    "the same, early, and straps do not correct it": Case(wrong=-0.03, corrects=False),
    "cadence +10 %": Case(speed=1.1),
    "cadence -10 %": Case(speed=0.9),
    "hips 3 degrees more flexed (trunk leans)": Case(variation=Variation(lean=math.radians(3.0))),
    "hips 3 degrees less flexed": Case(variation=Variation(lean=math.radians(-3.0))),
    "straps half as stiff": Case(stiffness=0.5),
    "straps twice as stiff": Case(stiffness=2.0),
    "payload +4 kg": Case(payload=4.0),
    "payload -4 kg": Case(payload=-4.0),
    "stride time varies by 2 %": Case(variation=Variation(stride_time=0.02, seed=1)),
    "right step 5 % of the stride longer": Case(variation=Variation(asymmetry=0.05)),
    "wearer of 1.60 m, 55 kg": Case(wearer=Wearer(1.60, 55.0)),
    "wearer of 1.90 m, 95 kg": Case(wearer=Wearer(1.90, 95.0)),
}


def walked(exo: Rig, case: Case, nominal: Simulation, causal: bool) -> dict[str, Any]:
    """Walk with the nominal stride's demand, or with causal control calibrated on it; return the summary."""
    rig = exo if case.wearer is None else dataclasses.replace(exo, wearer=case.wearer)
    request = Request(
        "level_walk", PAYLOAD + case.payload, speed=case.speed, cycles=STRIDES, law="inverse_dynamics", variation=case.variation
    )
    other = Simulation(rig, request)
    other.straps = other.straps.stiffened(case.stiffness)
    if causal:
        other.controlled_by(Causal(_of(nominal), first_phase=-case.late, late=case.wrong, corrects=case.corrects), seed=1)
    else:
        table = late(nominal.demand, case.late + case.wrong)
        other.demand = other.demand_added = table if other.motion.trial is None else other.motion.trial.played(table)
    return summarise(other.run())


def _of(nominal: Simulation) -> Calibration:
    assert nominal.calibration is not None
    return nominal.calibration


def work(joints: dict[str, list[float]]) -> float:
    """Return what the wearer's joints and feet give [J a stride]."""
    return sum(pair[0] for pair in joints.values())


def table(exo: Rig) -> list[str]:
    """Return the table's lines."""
    nominal = Simulation(exo, Request("level_walk", PAYLOAD, cycles=STRIDES, law="causal"))
    lines = [
        "| | metabolic W, estimated: backpack / rehearsed / causal | work of the wearer's joints, J a stride: the same | push ahead N: "
        "rehearsed / causal | hip / knee / ankle, N m rms: causal | residual, N m most: causal |",
        "|---|---|---|---|---|---|",
    ]
    for name, case in CASES.items():
        rehearsed, causal = (walked(exo, case, nominal, kind) for kind in (False, True))
        pack = causal["compared_with"]["backpack"]
        power = [pack["metabolic_w"], *(one["wearer"]["metabolic_w"]["value"] for one in (rehearsed, causal))]
        given = [work(pack["wearer_joints"]), *(work(one["ledger"]["wearer_joints"]) for one in (rehearsed, causal))]
        push = [one["wearer"]["forward_push_n"] for one in (rehearsed, causal)]
        last = " / ".join(f"{one:.0f}" for one in power[:2]) + (f" / **{power[2]:.0f}**" if power[2] > power[0] else f" / {power[2]:.0f}")
        moments = " / ".join(f"{one:.0f}" for one in causal["wearer"]["moment_rms_nm"].values())
        lines.append(
            f"| {name} | {last} | {' / '.join(f'{one:.0f}' for one in given)} | {' / '.join(f'{one:.0f}' for one in push)} | {moments} "
            f"| {causal['wearer']['pelvis_residual']['moment_peak_nm']:.0f} |"
        )
        print(lines[-1], flush=True)
    return lines
