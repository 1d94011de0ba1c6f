"""What straps and the ground do to the joints: forces recorded at sites of the model, as generalised forces.

A strap pulls at its site. The ground pushes somewhere under the foot: where is known only if `<site>.pressure_centre` was recorded, so that
while a foot is loaded the moment at the joints above it is not; a slide above it feels the force alone, wherever it acts. Nor does a place
along the sole say much of a force along the sole. At those samples and joints the balance is not judged.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from exo_sim.diagnosis.policy.recordings import GLANCING, UNLOADED_NOISE, UNLOADED_SHARE
from exo_sim.diagnosis.subsystems.motion.smoothing import reach, smoothed_alike, smoothing_width, stride, thinned
from exo_sim.machine.unmeasured_contact import without_ground_force
from exo_sim.recording.filters import noise_gain
from exo_sim.recording.noise import white_noise
from exo_sim.recording.table import Recording

Array = NDArray[np.float64]

STRAP, GROUND, CENTRE = "strap_force", "ground_force", "pressure_centre"
#: A column of the Jacobian below this does nothing [m/rad or 1].
_NOTHING = 1e-9
#: A smoothing filter reaches this many widths to either side.
_REACH = 2.5


@dataclass(frozen=True)
class SiteForce:
    """One force on the machine, as it was recorded.

    Attributes:
        site: Its index in the model.
        force: In space, 0 along axes that were not recorded [N], shape (n, 3).
        ahead: How far ahead of the site it acts, along the x axis of the site's body [m], shape (n,).
        recorded: Which axes were, shape (3,).
        placed: Whether it acts at `ahead`, and not at the site.
        unplaced: Where the machine is loaded at a point that is not known, shape (n,).
        loaded: Where it is loaded at all, shape (n,).
        variance: What sensor noise leaves in it behind the filter of the balance, by axis [N^2], shape (3,).
        strayed: The same of `ahead` [m^2].
    """

    site: int
    force: Array
    ahead: Array
    recorded: NDArray[np.bool_]
    placed: bool
    unplaced: NDArray[np.bool_]
    loaded: NDArray[np.bool_]
    variance: Array
    strayed: float


@dataclass(frozen=True)
class ContactForces:
    """All of them at the joints.

    Attributes:
        force: Generalised forces, of what is known of them, behind the filter of the balance, shape (n, nv).
        known: Where nothing else is missing, shape (n, nv).
        variance: What sensor noise leaves in `force`, shape (nv,).
        reached: Degrees of freedom that any of them moves, shape (nv,).
    """

    force: Array
    known: NDArray[np.bool_]
    variance: Array
    reached: NDArray[np.bool_]


def are_recorded(recording: Recording) -> bool:
    """Return whether a recording holds forces of straps or of the ground."""
    return bool(_sites(recording))


def site_forces(recording: Recording, model: mujoco.MjModel, smoothing: float = 0.0) -> tuple[list[SiteForce], str]:
    """Return the forces on the machine, and why they do not tell what pushes it, or ""; `smoothing` is what noise asks for [s]."""
    sites = _sites(recording)
    strange = [name for name, _ in sites if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, name) < 0]
    if strange:
        return [], f"the model has no site {', '.join(strange[:2])}, where forces were recorded"
    found = [_site_force(recording, model, name, kind, smoothing) for name, kind in sites]
    lacking = without_ground_force(model, [one.site for (_, kind), one in zip(sites, found, strict=True) if kind == GROUND])
    if lacking:
        return [], f"{lacking} touches the ground, and the ground's force on it was not recorded"
    return found, ""


def _sites(recording: Recording) -> list[tuple[str, str]]:
    """Return sites with a recorded force, and of which kind."""
    parts = (key.rsplit("_", 1)[0].rsplit(".", 1) for key in recording.columns if "." in key)
    return sorted({(one[0], one[1]) for one in parts if len(one) == 2 and one[1] in (STRAP, GROUND)})


def _site_force(recording: Recording, model: mujoco.MjModel, name: str, kind: str, smoothing: float) -> SiteForce:
    time = recording.time
    seconds, every, step = smoothing_width(time, smoothing), stride(time), float(np.median(np.diff(time)))
    n = len(thinned(time, every))
    force, recorded, variance = np.zeros((n, 3)), np.zeros(3, dtype=bool), np.zeros(3)
    loaded = np.zeros(len(time), dtype=bool)
    for axis, letter in enumerate("xyz"):
        values = recording.get(f"{name}.{kind}_{letter}")
        if values is None:
            continue
        there, noise = np.isfinite(values), white_noise(values)
        if not there.any():
            continue
        force[:, axis], recorded[axis] = np.interp(thinned(time, every), time[there], values[there]), True
        variance[axis] = (noise * noise_gain(0, seconds, step)) ** 2
        loaded |= np.abs(values) > max(UNLOADED_NOISE * noise, UNLOADED_SHARE * float(np.nanmax(np.abs(values))))
    if kind == STRAP:
        loaded[:] = True
    loaded = binary_dilation(loaded, iterations=max(1, int(_REACH * seconds / step)))
    centre = recording.get(f"{name}.{CENTRE}") if kind == GROUND else None
    strayed = 0.0 if centre is None else (white_noise(centre[loaded]) * noise_gain(0, seconds, step)) ** 2
    unplaced, ahead = loaded if kind == GROUND else np.zeros_like(loaded), np.zeros(n)
    if centre is not None:
        there = np.isfinite(centre)
        ahead = np.interp(thinned(time, every), time[there], centre[there]) if there.any() else ahead
        unplaced = np.zeros_like(loaded)
    site = int(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, name))
    return SiteForce(site, force, ahead, recorded, centre is not None, unplaced[::every], loaded[::every], variance, strayed)


class AtJoints:
    """Gathers what forces at sites do to the joints, sample by sample.

    Args:
        model: Of the machine.
        forces: On it.
        time: Of the samples, shape (n,).
        smoothing: Width of the filter that noise asks for [s].
    """

    def __init__(self, model: mujoco.MjModel, forces: Sequence[SiteForce], time: Array, smoothing: float = 0.0) -> None:
        count = len(time)
        self._model, self._forces, self._smoothing = model, forces, smoothing
        self._force, self._known = np.zeros((count, model.nv)), np.ones((count, model.nv), dtype=bool)
        self._variance, self._reached = np.zeros(model.nv), np.zeros(model.nv, dtype=bool)
        self._time, self._glanced = time, np.zeros_like(self._known)
        if forces:  # a recording that begins or ends with a loaded foot begins with a jump
            inside = _REACH * smoothing_width(time, smoothing)
            self._known[(time < time[0] + inside) | (time > time[-1] - inside)] = False

    def add(self, i: int, data: mujoco.MjData) -> None:
        """Take sample `i`, at which `data` has the machine's pose."""
        if not self._forces:
            return
        moved, turned = np.zeros((2, 3, self._model.nv))
        for one in self._forces:
            body = int(self._model.site_bodyid[one.site])
            ahead = data.xmat[body].reshape(3, 3)[:, 0]
            point = data.site_xpos[one.site] + one.ahead[i] * ahead
            mujoco.mj_jac(self._model, data, moved, turned, point, body)
            reached = (np.abs(moved) > _NOTHING).any(axis=0) | (np.abs(turned) > _NOTHING).any(axis=0)
            self._reached |= reached
            self._force[i] += one.force[i] @ moved
            across = np.cross(ahead, one.force[i])
            self._variance += (one.variance @ moved**2 + one.strayed * (across @ turned) ** 2) / len(self._time)
            if one.unplaced[i]:
                self._known[i] &= ~(np.abs(turned) > _NOTHING).any(axis=0)
            elif one.placed and one.loaded[i] and abs(one.force[i] @ ahead) > GLANCING * float(np.linalg.norm(one.force[i])):
                self._glanced[i] |= (np.abs(turned) > _NOTHING).any(axis=0)
            if one.loaded[i] and not one.recorded.all():
                self._known[i] &= ~(np.abs(moved[~one.recorded]) > _NOTHING).any(axis=0)

    def gathered(self) -> ContactForces:
        """Return what came of all samples."""
        self._known &= ~binary_dilation(self._glanced, np.ones((2 * reach(self._time, self._smoothing) + 1, 1), dtype=bool))
        each = partial(smoothed_alike, self._time, asked=self._smoothing)
        force = np.apply_along_axis(each, 0, self._force) if self._forces else self._force
        return ContactForces(force, self._known, self._variance, self._reached)
