"""What the machine of cylinders that can be bought does, with all that it weighs."""

from __future__ import annotations

from pathlib import Path

from exo_sim import rig as rigs
from exo_sim.errors import Diverged
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.walk import Request, default_rig
from exo_sim.simulation.worn import Simulation

HEADING = "A machine of cylinders that can be bought"
TEXT = """## A machine of cylinders that can be bought

`assets/exo.toml` runs at the paper's 250 psi, for which no cylinder after ISO 15552 is rated. `assets/exo_9_bar.toml` runs at 9 bar
absolute with cylinders of the catalogue (hip 63 mm, knee 50 mm), longer levers, larger valves, and bodies that carry the mass of cylinders
and valves: its frame weighs @FRAME@ kg where that of `exo.toml` weighs 20. Its ankle springs are twice as stiff (200 N m/rad).

"""
AFTER = """
The cylinders are rated for 11 bar absolute, which squats with 20 kg pass. Walking, both payloads cost less than as a backpack,
though cylinders and valves are a good part of what is carried. It does not squat with 45 kg: deep in the squat the hip
cylinder has too short a lever. Chambers get below freezing, so that its air must be dried.
"""


CASES = (
    ("walking, 34 kg, rehearsed", "level_walk", 34.0, "least_load"), ("walking, 34 kg, causal", "level_walk", 34.0, "causal"),
    ("walking, 45 kg, rehearsed", "level_walk", 45.0, "least_load"), ("squat, 20 kg", "squat", 20.0, "least_load"),
    ("squat, 45 kg", "squat", 45.0, "least_load"), ("sit to stand, 45 kg", "sit_to_stand", 45.0, "least_load"),
)  # fmt: skip


def row(rig: rigs.Rig, name: str, scenario: str, payload: float, law: str) -> str:
    """Return a row of the table."""
    walks = scenario == "level_walk"
    try:
        simulation = Simulation(rig, Request(scenario, payload, cycles=10 if walks else 3, law=law))
        walk = simulation.run()
    except Diverged:
        return f"| {name} | falls | - | - | - | - | - |"
    numbers = summarise(walk)
    cylinders = numbers["cylinders"].values()
    left = min(
        float(min(walk.columns[f"{key}.length"].min(), one.stroke - walk.columns[f"{key}.length"].max()))
        for key, one in rig.cylinders.items()
    )
    wearer, pack = numbers["wearer"], numbers["compared_with"]["backpack"]
    found = (wearer["metabolic_w"]["value"], pack["metabolic_w"], wearer["forward_push_n"])
    return (
        f"| {name} | {' | '.join(f'{one:.0f}' if walks else '-' for one in found)} "
        f"| {max(one['pressure_peak_pa'] for one in cylinders) / 1e5:.1f} "
        f"| {min(one['temperature_least_k'] for one in cylinders):.0f} | {1e3 * left:.0f} |"
    )


def section() -> str:
    """Return the section with its table."""
    rig = rigs.read(Path(default_rig()).parent / "exo_9_bar.toml")
    rows = [
        "| | metabolic W, estimated | as a backpack W | push ahead N | largest chamber bar | coldest K | least stroke left mm |",
        "|---|---|---|---|---|---|---|",
    ]
    for case in CASES:
        rows.append(row(rig, *case))
        print(rows[-1], flush=True)
    bodies = Simulation(rig, Request("stand", 0.0, law="inverse_dynamics")).model.body_mass
    return TEXT.replace("@FRAME@", f"{bodies.sum():.1f}") + "\n".join(rows) + "\n" + AFTER
