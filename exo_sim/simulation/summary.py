"""What a run comes to: the numbers of the `run` JSON, also of one that comes piece by piece."""

from __future__ import annotations

from typing import Any

import numpy as np

from exo_sim.physics.pneumatics import Books
from exo_sim.rig import Rig
from exo_sim.rig.limits import Reached, passed
from exo_sim.simulation import gas_use, work_balance
from exo_sim.simulation.running_statistics import Change, Least, Mean, Peak, Rms, joined, values
from exo_sim.simulation.walk import JOINTS, Walk
from exo_sim.simulation.wearer_load import Wearing, alone, hung, wearing, with_pack, with_payload

#: What cylinders after ISO 15552 and ISO 6432 are rated for, 10 bar above the atmosphere [Pa], and where water freezes [K].
RATED_PRESSURE, FREEZING = 11.0e5, 273.15
#: Cycles at the start that are left out, where enough others remain.
SETTLING = 2


def span(walk: Walk) -> slice:
    """Return the rows that count: whole cycles, the first two of the run left out where at least one other remains.

    A later piece of a run begins with a whole cycle, and its first piece, where others follow, holds more than it leaves out.
    """
    per_cycle = walk.motion.period / walk.step
    end = walk.first + len(walk.time)
    whole = int((end + 0.5) / per_cycle + 1e-9)
    if whole < 1:
        return slice(0, len(walk.time))
    first = max(walk.first, round(min(SETTLING, whole - 1) * per_cycle))
    return slice(first - walk.first, min(round(whole * per_cycle), end) - walk.first)


class Summary:
    """Takes in a run piece by piece."""

    def __init__(self) -> None:
        self._measured: dict[str, Any] | None = None
        self._scenario, self._simulated = "", 0.0
        self._rig: Rig | None = None
        self._period = 0.0
        self._books: Books | None = None
        self._walk: Walk | None = None
        self._payload = Mean(0.0, 0)

    def add(self, walk: Walk, wearer: Wearing | None = None) -> None:
        """Take in the next piece; `wearer` where what he gives is known."""
        self._scenario, self._books = walk.request.scenario, walk.books
        self._simulated = float((walk.first + len(walk.time)) * walk.step)
        self._rig, self._period = walk.rig, walk.motion.stride_time
        rows = span(walk)
        if rows.stop > rows.start:
            measured = measure(walk, rows, wearer if wearer is not None else wearing(walk))
            self._payload = self._payload.joined(Mean.of(walk.payload[rows]))
            self._walk = walk
            self._measured = measured if self._measured is None else joined(self._measured, measured)

    def numbers(self) -> dict[str, Any]:
        """Return the numbers over whole cycles, without file names and wall time."""
        out = {"schema": "exo-sim/run/1", "scenario": self._scenario, "simulated_s": self._simulated, **values(self._measured or {})}
        if self._walk is not None:
            self._conclude(out, self._walk)
        if "gas" in out and self._rig is not None:
            out["gas"] = gas_use.numbers(out["gas"], self._rig, self._period)
        reached = out.pop("reached", {})
        warned = warnings(out.get("cylinders", {}))
        if self._rig is not None:
            warned += limits_passed(self._rig, out.get("cylinders", {}), reached)
        if warned:
            out["warnings"] = warned
        if self._books is not None:
            out["books"] = {
                "gas_mass_residual": self._books.mass_residual,
                "gas_energy_residual": self._books.energy_residual,
            }
        return out


    def _conclude(self, out: dict[str, Any], walk: Walk) -> None:
        """Add what follows from the numbers: the closure, the metabolic power, and the same wearer without the machine."""
        out["ledger"] = work_balance.closed(out["ledger"])
        out["wearer"]["metabolic_w"] = work_balance.cost_of(out["ledger"]["wearer_joints"], walk).as_json()
        out["compared_with"] = {
            "no_machine": work_balance.compared(alone(walk), walk),
            "backpack": work_balance.compared(with_payload(walk, self._payload.value() + hung(walk)), walk),
        }


def warnings(cylinders: dict[str, Any]) -> list[str]:
    """Return what cylinders bought from a shelf would not stand, of the numbers of each, as plain sentences."""
    if not cylinders:
        return []
    warned = []
    name = max(cylinders, key=lambda one: float(cylinders[one]["pressure_peak_pa"]))
    if (peak := cylinders[name]["pressure_peak_pa"]) > RATED_PRESSURE:
        warned.append(
            f"{name} reaches {peak / 1e5:.1f} bar: cylinders after ISO 15552 and 6432 are rated for {RATED_PRESSURE / 1e5:.0f} bar absolute"
        )
    name = min(cylinders, key=lambda one: float(cylinders[one]["temperature_least_k"]))
    if (least := cylinders[name]["temperature_least_k"]) < FREEZING:
        warned.append(f"gas in {name} gets as cold as {least:.0f} K: moist air leaves ice there; dry it, or heat the chamber")
    return warned


def summarise(walk: Walk) -> dict[str, Any]:
    """Return the numbers of a whole run over whole cycles, without file names and wall time."""
    summary = Summary()
    summary.add(walk)
    return summary.numbers()


def measure(walk: Walk, rows: slice, wearer: Wearing) -> dict[str, Any]:
    """Return what some rows of a walk come to for what its wearer gives, as reductions in the places of the JSON's numbers."""
    part = {key: column[rows] for key, column in walk.columns.items()}
    torso = [name for name in walk.straps.names if name.startswith("torso")]
    up = {name: part[f"{name}.strap_force_z"] for name in walk.straps.names}
    ahead = {name: part[f"{name}.strap_force_x"] for name in walk.straps.names}
    torso_up = np.sum([up[name] for name in torso], axis=0)
    it, body = wearer.machine, wearer.body.moments[rows]
    extra, backpack = it.moments[rows] - body, with_pack(walk).moments[rows] - body
    moments = {
        title: {name: Rms.of(table[:, [k, k + 3]]) for k, name in enumerate(("hip", "knee", "ankle"))}
        for title, table in (("extra_moment_rms_nm", extra), ("backpack_moment_rms_nm", backpack))
    }
    out: dict[str, Any] = {
        "supported_weight_n": Mean.of(walk.weight[rows]),
        "mean_ground_force_n": Mean.of(part["foot_l.ground_force_z"] + part["foot_r.ground_force_z"]),
        "strap_load_n": {
            "vertical_mean": Mean.of(np.sum(list(up.values()), axis=0)),
            "torso_vertical_mean": Mean.of(torso_up),
            "torso_rms": Rms.of(torso_up),
            "torso_peak": Peak.of(np.abs(torso_up)),
            "torso_forward_rms": Rms.of(np.sum([ahead[name] for name in torso], axis=0)),
        },
        "wearer": {**moments, **work_balance.wearer_numbers(walk, rows, it)},
        "ledger": work_balance.measure(walk, rows, it),
        "joints": {
            name: {
                "torque_peak_nm": Peak.of(np.abs(part[f"{name}.torque"])),
                "torque_rms_nm": Rms.of(part[f"{name}.torque"]),
                "torque_error_rms_nm": Rms.of(part[f"{name}.torque"] - part[f"{name}.torque_demanded"]),
            }
            for name in JOINTS
        },
    }
    if walk.books is not None:
        cycles = (rows.stop - rows.start) * walk.step / walk.motion.stride_time
        out["cylinders"] = {
            name: {
                "pressure_peak_pa": Peak.of([part[f"{name}.pressure_1"].max(), part[f"{name}.pressure_2"].max()]),
                "temperature_least_k": Least.of([part[f"{name}.temperature_{side}"].min() for side in (1, 2)]),
                "choked_share": Mean.of(part[f"{name}.choked"] / 2),
                "gas_kg_per_stride": Change(float(part[f"{name}.gas_used"][0]), float(part[f"{name}.gas_used"][-1]), cycles),
            }
            for name in walk.rig.cylinders
        }
        out["reached"] = {
            name: {
                "stroke_left": Least.of([part[f"{name}.length"], cylinder.stroke - part[f"{name}.length"]]),
            }
            for name, cylinder in walk.rig.cylinders.items()
        }
        if walk.rig.cylinders:
            out["gas"] = gas_use.measure(walk, rows)
    return out


def limits_passed(rig: Rig, cylinders: dict[str, Any], reached: dict[str, Any]) -> list[str]:
    """Return sentences on strokes that were used up, and on pressures above the ratings that the rig's cylinders give."""
    given = {name: one["pressure_peak_pa"] if rig.cylinders[name].rating is not None else None for name, one in cylinders.items()}
    return list(passed(rig, {name: Reached(given[name], None, reached[name]["stroke_left"]) for name in cylinders}))
