"""What ideal devices save a wearer under 38 kg, one joint at a time, beside what was published of such devices."""

from __future__ import annotations

import numpy as np

from exo_sim.rig import Rig
from exo_sim.simulation import work_balance
from exo_sim.simulation.ideal_device import DEVICES, assisted
from exo_sim.simulation.walk import Request
from exo_sim.simulation.wearer_load import alone, with_payload
from exo_sim.simulation.worn import Simulation

LOAD = 38.0
HEADING = "Ideal devices, one joint at a time"
TEXT = f"""## {HEADING}

Dembia, Silder, Uchida, Hicks and Delp (2017, PLoS ONE 12:e0180320) gave seven people under 38 kg, in simulation, devices without mass or
limit on torque, each for one joint and one direction on both legs, and let muscles share anew what was left. The same is done here to the
simulated wearer of 1.70 m and 75 kg, who walks on the level at 1.2 m/s with {LOAD:.0f} kg as a backpack
(`exo_sim/simulation/ideal_device.py`): the device takes all of his joint's moment that has its direction, his motion stays. He costs
@PLAIN@ W by our estimate, and @ALONE@ W without load. Saved is a share of all that walking costs him. Bounds are of the estimate at each
of its ends, for his motion prescribed. Power is of both devices together.

"""
AFTER = """
Published: devices for hip flexion, knee flexion and hip abduction saved more than one for ankle plantarflexion (p < 0.05), and that for hip
abduction saved most for its peak power. @ORDER@
The estimate counts what a joint gives and takes, whoever gives it. Theirs counts muscles: a calf works with its tendon, so that the power
of the ankle costs little and its device saves little; a muscle that swings the leg ahead costs in both joints it spans and where it only
holds; and frontal moments, which a plane does not know, cost as well. So this estimate must not be used to choose which joint to power: it
gives the ankle too much. What it compares on this page are whole machines on hips and knees against the same load carried.
"""


def section(exo: Rig) -> str:
    """Return the section with its table."""
    columns, costs = [], []
    for wearer in ("prescribed", "torques"):
        request = Request("level_walk", LOAD, cycles=1, law="inverse_dynamics", wearer=wearer)
        walk = Simulation(exo, request).run()
        loaded = with_payload(walk, LOAD)
        columns.append((walk, loaded))
        costs.append([work_balance.compared(one, walk)["metabolic_w"] for one in (loaded, alone(walk))])
    rows = [
        "| device | saved W, estimated (bounds) | saved % | the same, moved by torques | most torque N m/kg | most power W/kg "
        "| mean power given and taken W |",
        "|---|---|---|---|---|---|---|",
    ]
    saved = {}
    for name in DEVICES:
        cells = []
        for walk, loaded in columns:
            plain = work_balance.compared(loaded, walk)
            found = assisted(loaded, name)
            helped = work_balance.compared(found.wearer, walk)
            less = {key: plain[key] - helped[key] for key in ("metabolic_w", "metabolic_low_w", "metabolic_high_w")}
            if not cells:
                saved[name] = less["metabolic_w"]
                power = found.power.sum(axis=1)
                given = [float(np.mean(part(found.power, 0.0).sum(axis=1))) for part in (np.maximum, np.minimum)]
                mass = walk.person.mass
                last = [f"{np.abs(found.torque).max() / mass:.2f}", f"{power.max() / mass:.2f}", f"{given[0]:+.0f} {given[1]:+.0f}"]
                cells.append(f"{less['metabolic_w']:.0f} ({less['metabolic_low_w']:.0f} to {less['metabolic_high_w']:.0f})")
            cells.append(f"{100 * less['metabolic_w'] / plain['metabolic_w']:.0f}")
        rows.append(f"| {name} | {' | '.join([*cells, *last])} |")
        print(rows[-1], flush=True)
    single = sorted((name for name in DEVICES if "both" not in name), key=lambda one: -saved[one])
    order = f"By our estimate the order of the single devices is {', '.join(single)}."
    words = TEXT.replace("@PLAIN@", f"{costs[0][0]:.0f}").replace("@ALONE@", f"{costs[0][1]:.0f}")
    return words + "\n".join(rows) + "\n" + AFTER.replace("@ORDER@", order)
