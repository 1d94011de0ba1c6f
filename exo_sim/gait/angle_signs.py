"""Which way the angles of a trial count: others bend the knee positive, or call a right angle the ankle's zero.

The machine counts flexion of the hip, extension of the knee and dorsiflexion of the ankle positive, a straight leg is zero. A walk tells
which way its own angles count: a knee bends by 60 degrees and hardly overextends; while it bends most, the thigh swings forward; and the
fastest that an ankle turns is the push that ends the stance (Perry and Burnfield, "Gait Analysis", 2nd ed. 2010, chapters 3 to 6).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from exo_sim.errors import ScenarioError
from exo_sim.gait.walking_trial import JOINTS, Trial

#: Mean angles beyond which zero is another posture: ankle at a right angle, leg straight at 180 degrees [rad].
_RIGHT_ANGLE, _HALF_TURN = np.radians(50.0), np.radians(100.0)
#: Beyond this an angle of a leg is none [rad]; less than this in all is no walking.
_MOST, _LEAST_RANGE = np.radians(170.0), np.radians(3.0)


def counted_as_machine(trial: Trial) -> Trial:
    """Return the trial with zeros and signs of the machine, and with a remark for each that was changed.

    Raises:
        ScenarioError: an angle that no leg has, or that does not move at all.
    """
    angles = dict(trial.angles)
    remarks = list(trial.remarks)

    def change(joint: str, sign: float, zero: float, words: str) -> None:
        for side in "lr":
            angles[f"{joint}_{side}"] = sign * (angles[f"{joint}_{side}"] - zero)
        remarks.append(f"{trial.file_name}: {words}")

    def both(joint: str) -> np.ndarray:
        return np.concatenate([angles[f"{joint}_l"], angles[f"{joint}_r"]])

    if abs(float(np.nanmean(both("ankle")))) > _RIGHT_ANGLE:
        zero = float(np.sign(np.nanmean(both("ankle")))) * np.pi / 2
        change("ankle", 1.0, zero, "the ankle's angles are counted from a right angle; 90 degrees were taken off")
    for joint in ("hip", "knee"):
        if abs(float(np.nanmean(both(joint)))) > _HALF_TURN:
            zero = float(np.sign(np.nanmean(both(joint)))) * np.pi
            change(joint, 1.0, zero, f"the {joint}'s angles are 180 degrees where it is straight; that was taken off")
    knee = both("knee")
    if np.nanmax(knee) > -np.nanmin(knee):
        change("knee", -1.0, 0.0, "knee flexion is positive there; the machine counts extension positive, so it was turned about")
    if _votes(angles, "hip") < 0:
        change("hip", -1.0, 0.0, "hip flexion is negative there; it was turned about")
    if _votes(angles, "ankle") > 0:
        change("ankle", -1.0, 0.0, "dorsiflexion of the ankle is negative there; it was turned about")
    for name in JOINTS:
        if np.nanmax(np.abs(angles[name])) > _MOST:
            most = float(np.degrees(np.nanmax(np.abs(angles[name]))))
            raise ScenarioError(f"{trial.file_name}: {name} reaches {most:.0f} degrees, which no leg does; is its unit right?")
    if max(float(np.nanmax(angles[name]) - np.nanmin(angles[name])) for name in JOINTS) < _LEAST_RANGE:
        raise ScenarioError(f"{trial.file_name}: no angle moves by more than 3 degrees; is it walking, and is their unit right?")
    return replace(trial, angles=angles, remarks=tuple(remarks))


def _votes(angles: dict[str, np.ndarray], joint: str) -> float:
    """Return which way a joint turns where a walk tells: the hip at the knee's deepest bends, the ankle where it is fastest before them."""
    vote = 0.0
    for side in "lr":
        knee = np.nan_to_num(angles[f"knee_{side}"])
        rate = np.gradient(np.nan_to_num(angles[f"{joint}_{side}"]))
        # samples where the knee is bent by more than four fifths of its deepest bend, and begins to be
        bent = knee < np.nanmin(knee) + 0.2 * np.ptp(knee)
        if joint == "hip":
            bending = bent & (np.gradient(knee) < 0)
            vote += float(rate[bending].sum())
        else:
            # the push-off: while the knee bends from a quarter to three quarters of its deepest bend
            depth = (knee.max() - knee) / max(float(np.ptp(knee)), 1e-9)
            hip = np.nan_to_num(angles[f"hip_{side}"])
            push = (np.gradient(knee) < 0) & (depth > 0.25) & (depth < 0.75) & (hip < hip.mean())
            vote += float(rate[push].sum())
    return vote
