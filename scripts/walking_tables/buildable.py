"""What the machine of cylinders that can be bought does, with all that it weighs."""

from __future__ import annotations

from exo_sim import rig as rigs
from exo_sim.errors import Diverged
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.walk import Request, default_rig
from exo_sim.simulation.worn import Simulation

HEADING = "A machine of cylinders that can be bought"
TEXT = """## A machine of cylinders that can be bought

`exo_250_psi` runs at the paper's 250 psi, for which no cylinder after ISO 15552 is rated; `run` and `inspect` say so. The machine that
comes along, `exo`, runs at 8.6 bar absolute with cylinders of the catalogue (hip 63 mm, knee 50 mm; rated for 11 bar absolute), longer
levers, valves of 30 mm^2, and bodies that carry the mass of cylinders and valves: its frame weighs @FRAME@ kg where the other weighs 20.
A trunnion in the middle of the barrel holds a hip cylinder to the torso, so that only piston, rod and eye swing with the thigh.

Its ankle springs have 250 N m/rad. They were chosen among 200 to 320 by walks on the level, fast, up the slope and from rest to rest, and
by six rows of causal control: stiffer ones cost less on the level and more up the slope and from rest to rest, softer ones more on the
level.

"""
AFTER = """
The demand prices chambers from 95 % of their rating on (`exo_sim/simulation/chamber_limits.py`). Walks stay within the rating of 11 bar but
for walking fast, which passes it by 0.4 bar (13.4 bar with a supply of 9 bar and without that price, commit 0edf261d), and down stairs,
by 0.5 bar: a chamber that is shut in is pressed together. `exo-sim run` says so. Squats reach 11.0 bar; rehearsed by feet that stay where
they are planned they saw 12.3 bar and left 310 and 425 N m (commit 23c0fca9).
Squatting and sitting, the residual passes the guideline of 75 N m. In a squat that is the ankle's spring, which pushes the machine back as
its ankle bends, and which nothing lets go: with 20 kg 295 N m are left with it, 184 N m with one of 80 N m/rad, 97 N m with a free ankle
and 54 N m with a powered one; alone and with the backpack it is 7 and 16 N m, and a residual that is priced ten times as high takes off a
tenth. Chambers get below freezing, so that the air must be dried.
"""
CASES = (
    ("walking, 34 kg, rehearsed", "level_walk", 34.0, "least_load"), ("walking, 34 kg, causal", "level_walk", 34.0, "causal"),
    ("walking, 45 kg, rehearsed", "level_walk", 45.0, "least_load"), ("slow, 34 kg", "slow_walk", 34.0, "least_load"),
    ("fast, 34 kg", "fast_walk", 34.0, "least_load"), ("up a slope, 34 kg", "slope_up", 34.0, "least_load"),
    ("down a slope, 34 kg", "slope_down", 34.0, "least_load"), ("uneven load, 34 kg", "uneven_load", 34.0, "least_load"),
    ("stairs up, 34 kg", "stairs_up", 34.0, "least_load"), ("stairs down, 34 kg", "stairs_down", 34.0, "least_load"),
    ("starting and stopping, 34 kg", "start_and_stop", 34.0, "least_load"), ("squat, 20 kg", "squat", 20.0, "least_load"),
    ("squat, 34 kg", "squat", 34.0, "least_load"), ("sit to stand, 45 kg", "sit_to_stand", 45.0, "least_load"),
)  # fmt: skip
#: What repeats itself in place is not walking, and is not held against a backpack.
_IN_PLACE = ("squat", "sit_to_stand")


def row(rig: rigs.Rig, name: str, scenario: str, payload: float, law: str) -> str:
    """Return a row of the table."""
    walks = scenario not in _IN_PLACE
    cycles = 10 if scenario == "level_walk" else 6 if walks and scenario != "start_and_stop" else 3
    try:
        simulation = Simulation(rig, Request(scenario, payload, cycles=cycles, law=law))
        walk = simulation.run()
    except Diverged:
        return f"| {name} | falls | - | - | - | - | - | - |"
    numbers = summarise(walk)
    cylinders = numbers["cylinders"].values()
    left = min(
        float(min(walk.columns[f"{key}.length"].min(), one.stroke - walk.columns[f"{key}.length"].max()))
        for key, one in rig.cylinders.items()
    )
    wearer, pack = numbers["wearer"], numbers["compared_with"]["backpack"]
    cost = wearer["metabolic_w"]["value"]
    shown = f"**{cost:.0f}**" if cost > pack["metabolic_w"] else f"{cost:.0f}"
    found = [shown, f"{pack['metabolic_w']:.0f}", f"{wearer['forward_push_n']:.0f}"]
    return (
        f"| {name} | {' | '.join(one if walks else '-' for one in found)} | {wearer['pelvis_residual']['moment_peak_nm']:.0f} "
        f"| {max(one['pressure_peak_pa'] for one in cylinders) / 1e5:.1f} "
        f"| {min(one['temperature_least_k'] for one in cylinders):.0f} | {1e3 * left:.0f} |"
    )


def section() -> str:
    """Return the section with its table."""
    rig = rigs.read(default_rig())
    rows = [
        "| | metabolic W, estimated | as a backpack W | push ahead N | residual, N m most | largest chamber bar | coldest K "
        "| least stroke left mm |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for case in CASES:
        rows.append(row(rig, *case))
        print(rows[-1], flush=True)
    bodies = Simulation(rig, Request("stand", 0.0, law="inverse_dynamics")).model.body_mass
    return TEXT.replace("@FRAME@", f"{bodies.sum():.1f}") + "\n".join(rows) + "\n" + AFTER
