"""A wearer who is a body, on other walks than the usual one: slow, fast, an uneven load, starting and stopping."""

from __future__ import annotations

from exo_sim.errors import Diverged
from exo_sim.rig import Rig
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.walk import Request
from exo_sim.simulation.worn import Simulation
from walking_tables.disturbances import work
from walking_tables.variety import bold

HEADING = "A wearer who yields, on other walks"
#: Walks of these, with payloads [kg]; strides or, from rest to rest, walks one after the other.
CASES = (
    ("slow_walk", 34.0), ("fast_walk", 34.0), ("uneven_load", 34.0), ("start_and_stop", 20.0), ("start_and_stop", 34.0),
    ("start_and_stop", 45.0),
)  # fmt: skip
STRIDES, WALKS = 12, 8
TEXT = f"""## {HEADING}

`--wearer torques` on the scenarios above whose ground is level: {STRIDES} strides with `least_load`, the first two left out; from rest
to rest {WALKS} walks one after the other, with a demand that is smoother still. He knows the motion and expects the straps' load that a
prescribed wearer had. Bold: more than the backpack. Where he falls, in brackets when.

"""
AFTER = """
Walking fast he pulls the machine with more than 20 N, and the weak spring that holds his pelvis passes the guideline of 25 N. From rest
to rest he no longer falls, but with `exo` he spends more than with the backpack and does more work, and with 45 kg what holds him passes
the guideline; with `exo_250_psi` he spends 1 to 3 % less, for 1 to 3 % more work. It hangs on the trunk's spring: with a tenth more of
its damper, or a fifth less, he falls with 20 kg in the seventh walk, and before (commit d0ff05c1) he fell there with 20 and 45 kg.
Slopes, stairs and squats are for a prescribed wearer.
"""


def section(exo: Rig, drawn: Rig) -> str:
    """Return the section, of the machine that comes along and of the lighter one."""
    lines = [
        "| | metabolic W, estimated: backpack / machine | work of the wearer's joints, J a stride: the same | push ahead N "
        "| residual at most, N and N m: backpack / machine |",
        "|---|---|---|---|---|",
    ]
    for machine in (exo, drawn):
        for name, payload in CASES:
            if machine is exo or name == "start_and_stop":
                lines.append(f"| {machine.name}, {name}, {payload:g} kg | {_walked(machine, name, payload)} |")
                print(lines[-1], flush=True)
    return TEXT + "\n".join(lines) + "\n" + AFTER


def _walked(machine: Rig, name: str, payload: float) -> str:
    """Return the cells of a row."""
    cycles = WALKS if name == "start_and_stop" else STRIDES
    try:
        numbers = summarise(Simulation(machine, Request(name, payload, cycles=cycles, wearer="torques")).run())
    except Diverged as fell:
        return f"falls ({str(fell).partition(' at ')[2].partition(' to ')[0]} s) | - | - | -"
    wearer, pack = numbers["wearer"], numbers["compared_with"]["backpack"]
    held = [one["pelvis_residual"] for one in (pack, wearer)]
    residual = [f"{one['force_peak_n']:.0f}, {one['moment_peak_nm']:.0f}" for one in held]
    power, carried = bold(wearer["metabolic_w"]["value"], pack["metabolic_w"]), work(pack["wearer_joints"])
    given = bold(work(numbers["ledger"]["wearer_joints"]), carried)
    return f"{pack['metabolic_w']:.0f} / {power} | {carried:.0f} / {given} | {wearer['forward_push_n']:.0f} | {' / '.join(residual)}"
