"""A wearer who is a body, moved by torques: his residual and ledger, against recordings, and when something is not as expected."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat

from exo_sim.control.causal import Causal
from exo_sim.errors import Diverged
from exo_sim.gait import recorded_gait, scenario
from exo_sim.gait.motion import phases
from exo_sim.gait.residual_reduction import reduced
from exo_sim.machine.person import Person
from exo_sim.rig import Rig
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.torque_driven_wearer import expect
from exo_sim.simulation.walk import Request, Walk
from exo_sim.simulation.wearer_alone import one_cycle
from exo_sim.simulation.wearer_load import alone, with_machine, with_payload
from exo_sim.simulation.worn import Simulation
from exo_sim.sizing.disturbances import late
from walking_tables.disturbances import CASES, STRIDES, work

PAYLOAD = 34.0
HEADING = "A wearer who yields"
SHARED = Path(__file__).resolve().parents[3] / "shared" / "data"
TEXT = f"""## {HEADING}

`exo-sim run level_walk --wearer torques` (in a scenario file `wearer = "torques"`) makes the wearer a body in the same MuJoCo model
(`exo_sim/machine/wearer_body.py`): trunk with pelvis, thighs, shanks, feet and toes with Winter's masses, on own soles beside the
machine's. Each sole touches with both ends of the heel's pad, ball and tip of the toes, so that the total centre of pressure cannot leave
them; soles are soft at first and stiffer the deeper they are pressed (`exo_sim/machine/sole_contact.py`), so that contacts do not chatter:
a test holds that a foot comes down and leaves once a stride, and that its force changes by less than 0.4 of the weight in 2 ms. Torques
move him (`exo_sim/control/wearer_torques.py`): inverse dynamics of the reference with the straps' load that he expects from a calibration
walk, springs and dampers to the reference's angles, and what brings pelvis and trunk back through the legs that stand (virtual model
control).
Without the machine a leg pushes ahead no harder than its sole can hold.
The foot in the air is put farther ahead where the pelvis is faster than its path and nearer where it is slower, by what a pendulum of a
leg's length asks (Hof 2008), as people do (Bruijn and van Dieen 2018), and a fifth of the way back to where the reference has it.
Shoulder straps only pull; the low torso strap stands for a belt with loops round the legs, which holds both ways, as pad and strap of a
cuff together and a shoe do. The same is done alone, with the payload as a backpack, and with the machine.

Springs and dampers grow with the payload, whether it is on his back or the machine's. The dampers are small, as people's are
(`exo_sim/control/wearer_torques.py`): with larger ones a foot was driven on when its ball met the ground, and the first peak of the force
was 1.25 of the weight.
He learns nothing from stride to stride. `least_load`, smoother for him, is rehearsed with a wearer whose motion is prescribed, by
linearised steps. Rehearsals with himself came after that before; they ended in 458 to 559 W with his pelvis held by 39 to 63 N at most, as
trifles had it, and with small dampers in 514 to 643 W. Without them five smoothnesses cost 436 to 471 W with 8 to 22 N, with the steps
that he took then (`exo_sim/control/load_weights.py`).
Toes are as stiff as people's (25 N m/rad: Sasaki, Neptune and Kautz
2009); the work of a
joint is that of its whole moment, springs of tissue among it.

A weak spring and damper hold the pelvis to the reference: 500 N/m ahead and up, 600 N m/rad. Their force is the residual. OpenSim's
guideline for residuals is 25 N and 75 N m at most, 10 N and 50 N m rms.

"""
AGAINST = """
Alone, against the mean recorded stride of a person of the same mass. Falisse's forces are scaled so that the vertical one sums to the
body weight. Asked were 0.2 N m/kg rms in the moments and 10 % of body weight in the vertical force: all are within it, Falisse's hip
barely. When the ball comes down the force rises faster than it was recorded: sole and foot give at three places only.

"""
OTHERS = """
In the next table the wearer knows his own motion and expects the straps' load of the calibration, and one thing is changed that the machine
does not know of. `rehearsed` and `causal` are as above. Twelve strides, the first two left out. The backpack is carried, with even steps
and the trunk that belongs to it, by a wearer who knows it. Bold: more than the backpack.

"""
LIMITS = """
With causal control he costs less than the backpack and does less work in every row, the push ahead is below 20 N (19 N on straps twice
as stiff), and 22 N and 11 N m hold him at most. What was missing was a step: he put his foot back to where the reference has it on the
ground, so that one who had fallen behind braked himself and fell behind farther, and was held by the weak spring
(`exo_sim/control/wearer_torques.py`). So walked he took 1.22 of the backpack's work with the longer right step, held by 81 N, 1.03 on
straps half as stiff, and 1.01 with the phase early and not corrected; with seven of nine other settings of the controller he fell in one
to three of eight rows. Demand and controller are the same: nothing of them was chosen by his walks; his gains were, with eight of these
rows in sight.

To learn from stride to stride what the straps do to him made it no better (with the steps of before): he then gives what the machine does
not. Of that load a fifth and two fifths a stride cost 478 and 505 W for 455 W with hips less flexed, and 500 and 517 W for 473 W with
straps twice as stiff.

What this leaves out: all is in the sagittal plane; the wearer knows the time of his stride and keeps to it, so that a stumble is answered
by a longer step and not by a quicker one; muscles have no delay and no largest force. `rehearsed` costs more than the backpack on straps
half as stiff, where 97 N hold him, and takes more work where it comes early, with a quicker cadence, hips more flexed and the taller
wearer. A run ends where he falls. He does so with the valves open, since legs that drag the machine need another gait, and in a squat;
sitting has no chair for him and is refused. The prescribed wearer stays the default.
"""


def section(exo: Rig) -> str:
    """Return the section."""
    simulation = Simulation(exo, Request("level_walk", PAYLOAD, cycles=STRIDES, law="causal", wearer="torques"))
    rehearsed = Simulation(exo, Request("level_walk", PAYLOAD, wearer="torques"))
    return (
        TEXT + "\n".join(columns(rehearsed.run())) + "\n" + AGAINST + "\n".join(against()) + "\n" + OTHERS
        + "\n".join(disturbed(exo, simulation)) + "\n" + LIMITS
    )  # fmt: skip


def columns(walk: Walk) -> list[str]:
    """Return the table of the wearer alone, with a backpack and with the machine."""
    summary, period = summarise(walk), walk.motion.period
    last = slice(len(walk.time) - 1 - round(period / walk.step), len(walk.time) - 1)
    three_walks = (alone(walk), with_payload(walk, PAYLOAD), with_machine(walk.part(last)))
    slides = [1e3 * float(one.slid(period).max()) for one in three_walks]
    wearer, ledger = summary["wearer"], summary["ledger"]
    cost = wearer["metabolic_w"]
    machine = {**wearer, "metabolic_w": cost["value"], "metabolic_low_w": cost["low"], "metabolic_high_w": cost["high"],
               "wearer_joints": ledger["wearer_joints"]}  # fmt: skip
    three = [summary["compared_with"]["no_machine"], summary["compared_with"]["backpack"], machine]
    residual = [one["pelvis_residual"] for one in three]

    def row(words: str, values: list[str]) -> str:
        return f"| {words} | {' | '.join(values)} |"

    out = ["| | alone | 34 kg as a backpack | machine, least_load |", "|---|---|---|---|"]
    out.append(row("residual force, N rms / most", [f"{one['force_rms_n']:.1f} / {one['force_peak_n']:.1f}" for one in residual]))
    out.append(row("residual moment, N m rms / most", [f"{one['moment_rms_nm']:.1f} / {one['moment_peak_nm']:.1f}" for one in residual]))
    out.append(row("centre of pressure outside the soles", [f"{100 * one['pressure_centre_outside_share']:.0f} %" for one in three]))
    out.append(row("hip / knee / ankle, N m rms", [" / ".join(f"{m:.0f}" for m in one["moment_rms_nm"].values()) for one in three]))
    out.append(row("a sole slides under its load, mm a stride (test: 8 alone and as a backpack)", [f"{way:.0f}" for way in slides]))
    for name in ("hip", "knee", "ankle", "foot"):
        out.append(row(f"work of the {name}, J a stride", ["{:+.0f} {:+.0f}".format(*one["wearer_joints"][name]) for one in three]))
    bounds = [f"{one['metabolic_w']:.0f} ({one['metabolic_low_w']:.0f} to {one['metabolic_high_w']:.0f})" for one in three]
    out.append(row("metabolic W, estimated (bounds)", bounds))
    strapped = ", ".join(f"{name} {value['rms']:.0f} / {value['peak']:.0f}" for name, value in wearer["strap_force_n"].items())
    return [
        *out, "",
        f"With the machine: forward push {wearer['forward_push_n']:.0f} N, power to the machine {wearer['power_to_machine_w']:.0f} W;",
        f"straps, N rms / most: {strapped}. The ledger closes to {abs(ledger['closure']):.2f} J a stride; soles and ground take",
        f"{-ledger['soles']:.0f} J, the residual gives {ledger['residual']:.0f} J. Work of the foot is that of the toes.",
    ]  # fmt: skip


def against() -> list[str]:
    """Return the table against recordings."""
    out = ["| recording | what | correlation | rms |", "|---|---|---|---|"]
    for name, scene in (("falisse", "level_walk"), ("opensim", "level_walk_opensim")):
        gait = recorded_gait.load(name)
        person = Person(1.70, gait.mass)
        try:
            it = one_cycle(reduced(scenario.motion(scene, person, 1.0), person), person)
        except Diverged:
            out.append(f"| {name} | falls | - | - |")
            continue
        rows = [(f"{joint} moment", it.moments[:, 3 + k], gait.moment[joint](phases()), gait.mass, "N m/kg")
                for k, joint in enumerate(("hip", "knee", "ankle"))]  # fmt: skip
        path = SHARED / "walking_falisse" / "ExperimentalData.mat"
        if name == "falisse" and path.exists():
            data = loadmat(path, squeeze_me=True, struct_as_record=False)["ExperimentalData"]
            measured = data.GRFs.subject1.mean[:, :2] * 50.0 / data.GRFs.subject1.mean[:, 1].mean()
            for k, axis in enumerate(("fore-aft", "vertical")):
                wanted = np.interp(phases(), np.arange(100) / 100, measured[:, k], period=1.0)
                rows.append((f"{axis} ground force", it.ground.force[:, 1, k] / (0.01 * 9.81 * gait.mass), wanted, 1.0, "% of body weight"))
        for what, got, wanted, scale, unit in rows:
            rms = float(np.sqrt(np.mean((got - wanted) ** 2))) / scale
            out.append(f"| {name} | {what} | {np.corrcoef(got, wanted)[0, 1]:.2f} | {rms:.{1 if unit.startswith('%') else 3}f} {unit} |")
        residual = it.ground.residual
        force, moment = np.hypot(residual[:, 0], residual[:, 1]), np.abs(residual[:, 2])
        out.append(f"| {name} | residual, most | - | {force.max():.1f} N, {moment.max():.1f} N m |")
    return out


def disturbed(exo: Rig, nominal: Simulation) -> list[str]:
    """Return the table of what is not as expected."""
    out = [
        "| | metabolic W, estimated: backpack / rehearsed / causal | work of the wearer's joints, J a stride: the same | push ahead N: "
        "rehearsed / causal | residual at most, N and N m: rehearsed / causal |",
        "|---|---|---|---|---|",
    ]
    for name in CASES:
        tried = [_tried(exo, nominal, name, causal) for causal in (False, True)]
        pack = next((one["compared_with"]["backpack"] for one in tried if one is not None), None)

        def said(value: Any, words: str = "{:.0f}", limit: float = math.inf, tried: list[Any] = tried) -> list[str]:
            found = ["falls" if one is None else words.format(value(one)) for one in tried]
            return [f"**{text}**" if one is not None and value(one) > limit else text for text, one in zip(found, tried)]

        limits = [math.inf, math.inf] if pack is None else [pack["metabolic_w"], work(pack["wearer_joints"])]
        carried = ["-", "-"] if pack is None else [f"{one:.0f}" for one in limits]
        power = said(lambda one: one["wearer"]["metabolic_w"]["value"], limit=limits[0])
        given = said(lambda one: work(one["ledger"]["wearer_joints"]), limit=limits[1])
        push = said(lambda one: one["wearer"]["forward_push_n"])
        force, moment = (said(lambda one, key=key: one["wearer"]["pelvis_residual"][key]) for key in ("force_peak_n", "moment_peak_nm"))
        residual = " / ".join(f"{f}, {m}" if f != "falls" else f for f, m in zip(force, moment))
        out.append(
            f"| {name} | {' / '.join([carried[0], *power])} | {' / '.join([carried[1], *given])} | {' / '.join(push)} "
            f"| {residual} |"
        )
        print(out[-1], flush=True)
    return out


def _tried(exo: Rig, nominal: Simulation, name: str, causal: bool) -> dict[str, Any] | None:
    """Walk with the nominal stride's demand, or with causal control calibrated on it; return the summary, or None after a fall."""
    case = CASES[name]
    rig = exo if case.wearer is None else dataclasses.replace(exo, wearer=case.wearer)
    request = Request(
        "level_walk", PAYLOAD + case.payload, speed=case.speed, cycles=STRIDES, law="inverse_dynamics", variation=case.variation,
        wearer="torques",
    )  # fmt: skip
    other = Simulation(rig, request)
    if case.wearer is None and case.variation is None and case.speed == 1.0:
        other.motion, other.torques = nominal.motion, nominal.torques
    else:  # he knows how he walks himself
        expect(other, nominal.expected)
    other.straps = other.straps.stiffened(case.stiffness)
    other.reset()
    if causal:
        assert nominal.calibration is not None
        controller = Causal(nominal.calibration, first_phase=-case.late, late=case.wrong, corrects=case.corrects)
        other.controlled_by(controller, seed=1)
    else:
        table = late(nominal.demand, case.late + case.wrong)
        other.demand = other.demand_added = table if other.motion.trial is None else other.motion.trial.played(table)
    try:
        return summarise(other.run())
    except Diverged:
        return None
