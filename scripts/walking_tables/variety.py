"""Other ground, other speeds, an uneven load: what the machine does there for a wearer whose motion is prescribed."""

from __future__ import annotations

from exo_sim.errors import Diverged
from exo_sim.rig import Rig
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.walk import Request
from exo_sim.simulation.worn import Simulation
from walking_tables.disturbances import work

HEADING = "Slopes, stairs, slow and fast, an uneven load, starting and stopping"
CASES = (
    ("slow_walk", 34.0), ("level_walk", 34.0), ("fast_walk", 34.0), ("slope_up", 34.0), ("slope_down", 34.0), ("uneven_load", 34.0),
    ("start_and_stop", 34.0), ("start_and_stop", 20.0), ("stairs_up", 34.0), ("stairs_up", 20.0), ("stairs_down", 34.0),
    ("stairs_down", 20.0),
)  # fmt: skip
STRIDES = 6
TEXT = f"""## {HEADING}

Each is a short scenario (`exo-sim run slope_up`); in a scenario file `speed = "0.9 m/s"`, `grade = 0.08`, `[stairs]` and `[hung]` make
others. All are for a wearer whose motion is prescribed. None was recorded:

- Speeds: stride time and stride length go with powers of speed, -0.58 and 0.42 (Grieve and Gear 1966), between 0.5 and 1.5 times the
  recorded speed (`exo_sim/gait/speed_and_slope.py`). The pelvis rises and falls with the power 0.69 of speed (Orendurff and others 2004),
  and stance is 3.5 % of the stride shorter for each metre a second more (Kirtley, Whittle and Jefferson 1985).
- Slopes of 10 %: feet do to the ground what they did on level ground, and hips, knees and ankles follow. At heel strike hip and knee are
  more flexed uphill, as Lay, Hass and Gregor (2006) measured; that people slow down uphill is left out.
- Stairs of 170 by 290 mm are drawn, with what Riener, Rabuffetti and Frigo (2002) say of them (`exo_sim/gait/stairs.py`).
- Uneven: 3 kg on the machine's left thigh beside the payload; the backpack holds them, too. The model is planar, a load to one side
  cannot be had.
- Starting and stopping: six steps between two times of stance, drawn from the recorded stride (`exo_sim/gait/start_and_stop.py`). Feet and
  centre of pressure are given, the pelvis follows as a pendulum that begins and ends at rest. Numbers are those of the whole of it, 5.2 s
  with 3.2 m of way, and the demand is planned over all of it.

{STRIDES} strides (walks from rest to rest: 3) with `least_load`, rehearsed, the first two left out. The backpack is the same load
carried by the same wearer.
Bold: more than the backpack.

"""
AFTER = """
The trunk's lean is chosen by residual reduction, the same way in every column; the residual is what soles on this ground cannot give. With
the machine it is beyond the guideline of 75 N m on stairs and, with 20 kg, from rest to rest: there the numbers say little of what a
person would feel. From rest to rest with 34 kg the machine cost 2 W more than the backpack and left 169 N m while rehearsals there went by
the feet as planned; they go by linearised steps now, in which a foot that bounces is no landing, and count what no sole can give four times
as much as in walking.

Where a load is uneven the trunk may sway unevenly, too.
"""


def table(exo: Rig) -> list[str]:
    """Return the table's lines."""
    lines = [
        "| | speed m/s | metabolic W, estimated: alone / backpack / machine | work of the wearer's joints, J a stride: backpack / machine "
        "| hip / knee / ankle, N m rms: machine | push ahead N | error of hip / knee torque, N m rms "
        "| residual, N m most: alone / machine |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for name, payload in CASES:
        try:
            simulation = Simulation(exo, Request(name, payload, cycles=None if name == "start_and_stop" else STRIDES))
            numbers = summarise(simulation.run())
        except Diverged:
            lines.append(f"| {name}, {payload:g} kg | - | falls | - | - | - | - | - |")
            continue
        wearer, others = numbers["wearer"], numbers["compared_with"]
        alone, pack = others["no_machine"], others["backpack"]
        power, given = wearer["metabolic_w"]["value"], work(numbers["ledger"]["wearer_joints"])
        carried = work(pack["wearer_joints"])
        moments = " / ".join(f"{one:.0f}" for one in wearer["moment_rms_nm"].values())
        errors = " / ".join(f"{numbers['joints'][f'{joint}_r']['torque_error_rms_nm']:.1f}" for joint in ("hip", "knee"))
        lines.append(
            f"| {name}, {payload:g} kg | {simulation.motion.advance / simulation.motion.period:.2f} "
            f"| {alone['metabolic_w']:.0f} / {pack['metabolic_w']:.0f} / {bold(power, pack['metabolic_w'])} "
            f"| {carried:.0f} / {bold(given, carried)} | {moments} | {wearer['forward_push_n']:.0f} | {errors} "
            f"| {alone['pelvis_residual']['moment_peak_nm']:.0f} / {wearer['pelvis_residual']['moment_peak_nm']:.0f} |"
        )
        print(lines[-1], flush=True)
    return lines


def bold(value: float, limit: float) -> str:
    return f"**{value:.0f}**" if value > limit else f"{value:.0f}"


def section(exo: Rig) -> str:
    """Return the section."""
    return TEXT + "\n".join(table(exo)) + "\n" + AFTER
