"""What the machine of cylinders that can be bought does, with all that it weighs."""

from __future__ import annotations

from pathlib import Path

from exo_sim import rig as rigs
from exo_sim.simulation.coupled import Simulation
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.walk import Request, default_rig

HEADING = "A machine of cylinders that can be bought"
TEXT = """## A machine of cylinders that can be bought

`assets/exo.toml` runs at the paper's 250 psi, for which no cylinder after ISO 15552 is rated. `assets/exo_9_bar.toml` runs at 9 bar
absolute with cylinders of the catalogue (hip 63 mm, knee 50 mm), longer levers, larger valves, and bodies that carry the mass of cylinders
and valves: its frame weighs @FRAME@ kg where that of `exo.toml` weighs 20. Its ankle springs are twice as stiff (200 N m/rad).

"""
AFTER = """
Metabolic power and push are walking's; `rated` is 11 bar. With 34 kg the gain over a backpack is small, with 45 kg there is none: the
cylinders are a good part of what is carried. All chambers get below freezing, so that its air must be dried.
"""


def section() -> str:
    """Return the section with its table."""
    rig = rigs.read(Path(default_rig()).parent / "exo_9_bar.toml")
    rows = [
        "| | metabolic W, estimated | as a backpack W | push ahead N | largest chamber bar | coldest K | least stroke left mm | too weak |",
        "|---|---|---|---|---|---|---|---|",
    ]
    frame = 0.0
    for name, scenario, payload, law in (
        ("walking, 34 kg, rehearsed", "level_walk", 34.0, "least_load"), ("walking, 34 kg, causal", "level_walk", 34.0, "causal"),
        ("walking, 45 kg, rehearsed", "level_walk", 45.0, "least_load"), ("squat, 45 kg", "squat", 45.0, "least_load"),
        ("sit to stand, 45 kg", "sit_to_stand", 45.0, "least_load"),
    ):  # fmt: skip
        cycles = 10 if scenario == "level_walk" else 3
        simulation = Simulation(rig, Request(scenario, payload, cycles=cycles, law=law))
        walk = simulation.run()
        frame = walk.weight[0] / 9.81 - payload
        numbers = summarise(walk)
        cylinders = numbers["cylinders"].values()
        left = min(
            float(min(walk.columns[f"{key}.length"].min(), one.stroke - walk.columns[f"{key}.length"].max()))
            for key, one in rig.cylinders.items()
        )
        wearer, pack = numbers["wearer"], numbers["compared_with"]["backpack"]
        walks = scenario == "level_walk"
        found = (wearer["metabolic_w"]["value"], pack["metabolic_w"], wearer["forward_push_n"])
        costs = " | ".join(f"{one:.0f}" if walks else "-" for one in found)
        rows.append(
            f"| {name} | {costs} | {max(one['pressure_peak_pa'] for one in cylinders) / 1e5:.1f} "
            f"| {min(one['temperature_least_k'] for one in cylinders):.0f} | {1e3 * left:.0f} | {'yes' if simulation.remarks else 'no'} |"
        )
        print(rows[-1], flush=True)
    return TEXT.replace("@FRAME@", f"{frame:.1f}") + "\n".join(rows) + "\n" + AFTER
