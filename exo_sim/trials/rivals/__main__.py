"""Rivals to hold a diagnosis against, on the same cases and under the same contract.

    exo-sim trial run trial --tool "python -m exo_sim.trials.rivals prune"

`nothing` finds every machine consistent; the others regress what the paper's balances leave over on one column an effect, in weak form
(windows of a smooth test function, derivatives moved onto it), and differ in how they choose: `threshold` drops small terms until none is
left to drop (as SINDy does), `prune` fits everything and drops the term that is missed least, `greedy` adds the term that lowers the error
most, `ensemble` keeps what most of many thresholded fits keep (pysindy's ensemble). `surrogate` names nothing: a Gaussian process learns
what the balances leave over from the signals, and where that predicts held-out time something is unknown. The last two need `pip install
'exo-sim-pneumatic[rivals]'`.
"""

from __future__ import annotations

import argparse
import json
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from exo_sim.trials.rivals.files import read, si
from exo_sim.trials.rivals.selection import WAYS, Chosen, choose
from exo_sim.trials.rivals.surrogate import NOTHING, explained
from exo_sim.trials.rivals.weak_form import Regression, force_balance, gas_balance


def diagnose(recordings: list[Path], rig_path: Path, how: str) -> dict[str, Any]:
    """Return a diagnosis of the first recording, as the contract wants it."""
    import mujoco

    report: dict[str, Any] = {"schema": "exo-sim/diagnosis/1", "verdict": "consistent", "located": [], "effects": []}
    if how == "nothing":
        return report
    rig = tomllib.loads(rig_path.read_text())
    model = mujoco.MjModel.from_xml_path(str(rig_path.parent / rig["model"]))
    data = mujoco.MjData(model)
    table = read(recordings[0])
    joints = [model.joint(i).name for i in range(model.njnt)]
    if any(f"{joint}.position" not in table for joint in joints):
        return report | {"verdict": "undetermined"}
    length = np.empty((len(table["time"]), model.nu))
    for i in range(len(length)):
        for joint in joints:
            data.joint(joint).qpos = table[f"{joint}.position"][i]
        mujoco.mj_fwdPosition(model, data)
        length[i] = data.actuator_length
    for name, cylinder in rig["cylinders"].items():
        if any(f"{name}.pressure_{n}" not in table for n in (1, 2)):
            report["verdict"] = "undetermined"
            continue
        x = length[:, model.actuator(cylinder["actuator"]).id] - si(cylinder["retracted_length"])
        balances = [gas_balance(name, cylinder, rig, table, x)]
        if model.njnt == 1:
            position = table[f"{joints[0]}.position"]
            balances.append(force_balance(name, cylinder, rig, table, x, position, model))
        for balance in balances:
            if how == "surrogate":
                _add_unknown(report, balance, explained(balance))
                continue
            for effect, chosen in choose(balance, how).items():
                _add(report, balance, effect, chosen, joints[0])
    kinds = {entry["kind"] for entry in report["effects"]}
    if kinds:
        report["verdict"] = "calibration" if kinds == {"calibration"} else "mismatch"
    return report


def _add(report: dict[str, Any], balance: Regression, column: str, chosen: Chosen, joint: str) -> None:
    name, parameter = column.removesuffix("_2"), balance.columns[column][1]
    value = chosen.value + (1.0 if name == "flow_capacity" else 0.0)
    calibration = name in ("flow_capacity", "dead_volume", "payload_mass")
    half = 1.96 * chosen.error
    report["effects"].append(
        {
            "name": name,
            "where": joint if name == "payload_mass" else balance.where[0],
            "kind": "calibration" if calibration else "missing_physics",
            "parameters": {parameter: {"value": value, "unit": "1", "low": value - half, "high": value + half}} if parameter else {},
            "evidence": {"log10_odds": 2.0 + 100 * max(chosen.gained, 0.0), "held_out_error_drop": chosen.gained},
            "ambiguous_with": [],
        }
    )
    if not calibration:
        _locate(report, balance, chosen.gained)


def _add_unknown(report: dict[str, Any], balance: Regression, share: float) -> None:
    if share <= NOTHING:
        return
    evidence = {"log10_odds": 2.0 + 100 * share, "held_out_error_drop": share}
    entry = {"name": "unknown", "where": balance.where[0], "kind": "unknown", "parameters": {}, "evidence": evidence, "ambiguous_with": []}
    report["effects"].append(entry)
    _locate(report, balance, share)


def _locate(report: dict[str, Any], balance: Regression, share: float) -> None:
    report["located"].append({"where": balance.where[0], "equation": balance.where[1], "share": share})
    report["located"].sort(key=lambda entry: -entry["share"])


def main(argv: list[str] | None = None) -> int:
    """Diagnose like a rival; see `--help`."""
    parser = argparse.ArgumentParser(prog="python -m exo_sim.trials.rivals", description=__doc__.splitlines()[0])
    parser.add_argument("how", choices=("nothing", *WAYS, "surrogate"))
    parser.add_argument("recordings", nargs="+", type=Path)
    parser.add_argument("--rig", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args(argv)
    report = diagnose(options.recordings, options.rig, options.how)
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "diagnosis.json").write_text(json.dumps(report, indent=1))
    return {"consistent": 0, "calibration": 0, "mismatch": 3}.get(report["verdict"], 4)


if __name__ == "__main__":
    raise SystemExit(main())
