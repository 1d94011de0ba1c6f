"""Motions with both feet flat on the ground: the ankles stay, and everything above follows from three angles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.gait.motion import SAMPLES, Motion, derivatives
from exo_sim.machine.person import Person, leg_points


def on_both_feet(
    person: Person,
    period: float,
    knee: NDArray[np.float64],
    ankle: NDArray[np.float64],
    lean: NDArray[np.float64],
    support: NDArray[np.float64] | None = None,
) -> Motion:
    """Return a motion on two flat feet, both legs alike.

    Args:
        person: Whose segments.
        period: Duration of a cycle [s].
        knee: Knee angle [rad], negative bent, smooth and periodic, shape (SAMPLES,).
        ankle: Dorsiflexion, which is the shank's forward lean [rad], the same.
        lean: Forward lean of the torso [rad], the same.
        support: As in `Motion`; 1 throughout where not given.
    """
    thigh = -ankle - knee
    point = leg_points(thigh, knee, ankle, person)
    height = -point["ankle"][:, 1] + person.ankle_height
    hip = thigh + lean
    position = np.stack([-point["ankle"][:, 0], height, -lean, hip, knee, ankle, hip, knee, ankle], axis=1)
    slope, curvature = derivatives(position)
    middle = 0.5 * (person.heel + person.toe)
    return Motion(
        period=period,
        advance=0.0,
        position=position,
        slope=slope,
        curvature=curvature,
        share=np.full((SAMPLES, 2), 0.5),
        pressure_centre=np.full((SAMPLES, 2), middle),
        contact=np.ones((SAMPLES, 4), dtype=bool),
        support=np.ones(SAMPLES) if support is None else support,
    )
