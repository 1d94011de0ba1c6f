"""The wearer's motion made one that a body with mass can do: trunk and pelvis move so that soles on the ground can hold it.

Recorded angles on a rigid chain break Newton's laws a little: the centre of pressure would have to leave the foot. As in residual
reduction (Delp and others 2007, IEEE Transactions on Biomedical Engineering 54:1940) the trunk leans a little more or less along the
cycle and the pelvis path is moved by millimetres over feet that stay where they are to a millimetre or two, by damped Gauss-Newton steps,
until the ground's force passes through the soles near where it is expected and aims at one point above the hips. Where it is expected is
shifted along the soles as well. On stairs and in a walk from rest to rest the pelvis is moved by more. The same is done for a body alone,
with a backpack, and with the machine: it says how each leans.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import ScenarioError
from exo_sim.gait import pendulum
from exo_sim.gait.footpaths import with_pelvis_ahead
from exo_sim.gait.motion import Motion, derivatives, travelling
from exo_sim.gait.moving_body import Moving, body_loads, trunk
from exo_sim.kept_solutions import kept
from exo_sim.machine import ground_reaction
from exo_sim.machine.leg_angles import held_back
from exo_sim.machine.person import LEG_START, Person
from exo_sim.machine.wearer_moments import backpack_wrench

#: Samples of a cycle that are looked at.
_EVERY = 8
#: Harmonics of the trunk and of the pelvis ahead, and of the pelvis up: those that both legs share in walking, the lowest in place. Angles
#: end at the eighth; half a millimetre of it that is left is a wave of 1 m/s^2, and the hip's moment follows the ground's force by 0.85 m.
_WALKING, _IN_PLACE, _HEIGHT = (2, 4, 6, 8), (1, 2), (4, 6, 8)
#: Of the trunk and of the pelvis ahead where what is carried is not the same left and right.
_UNEVEN = (1, 2, 3, 4, 6, 8)
#: What is thought little of: trunk leaning and swaying [rad], pelvis ahead and up [m], centre of pressure along the sole [m]. Markers on
#: the pelvis' skin move by 5 mm and more; with 1.5 mm the hip moments were 0.22 and 0.18 N m/kg rms off the recordings' (0.19 and 0.16).
_LEAN, _SWAY, _AHEAD, _UP, _CENTRE = np.radians(6.0), np.radians(3.0), 5e-3, 0.4e-3, 0.02
#: A moment is felt as the weight on this lever [m]; a force off its aim, and one that is jerky, as these shares of the weight.
_LEVER, _AIM, _JERK = 0.01, 0.010, 0.007
#: The centre of pressure may be expected so far ahead of the ball of the foot [m].
_BEYOND_BALL = 0.03
_STEPS, _DAMPING = 8, 1e-3
#: Height of a body's mass above the ground over the body's height, about (Winter 2009, table 4.1); rounds in which the pelvis is moved.
_MASS_HEIGHT, _ROUNDS = 0.56, 4
#: Walks move trunk and pelvis by up to three of the scales above; by more than so many, nothing was found.
_ABSURD = 15.0

#: Hip, knee and ankle of each leg among the coordinates.
_LEGS = [slice(first, first + 3) for first in LEG_START.values()]

#: Answers that are kept: a search for sizes asks for the same motions again and again.
_KEPT_MOST = 32
_kept: dict[bytes, NDArray[np.float64]] = {}


@dataclass(frozen=True)
class Carried:
    """What a wearer carries.

    Attributes:
        load: Gives, for samples of motions, the load on the wearer beside the own body, about the pelvis: x, z [N] and about -y [N m],
            shape (n, 3).
        content: All that `load` depends on beside the motion, as bytes.
    """

    load: Callable[[Moving], NDArray[np.float64]]
    content: bytes


@dataclass(frozen=True)
class _Parameters:
    """Names of the numbers that are looked for, and what each does."""

    harmonics: tuple[int, ...]
    heights: tuple[int, ...]

    def scales(self) -> NDArray[np.float64]:
        n = 2 * len(self.harmonics)
        ahead = [_AHEAD] * n if self.heights else []
        return np.array([_LEAN, _CENTRE, *[_SWAY] * n, *ahead, *[_UP] * (2 * len(self.heights))])

    def _moved(self, motion: Motion, person: Person, tried: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the coordinates with each of these values, shape (k, 9, n) for values of shape (k, m)."""
        n = 2 * len(self.harmonics)
        waves, heights = _basis(motion.phase, self.harmonics), _basis(motion.phase, self.heights) if self.heights else None
        position = np.empty((len(tried), motion.position.shape[1], len(motion.position)))
        position[:] = motion.position.T
        pitch = np.stack([values[0] + waves @ values[2 : 2 + n] for values in tried])
        position[:, 2] += pitch
        position[:, [3, 6]] -= pitch[:, None]
        if heights is not None:
            ahead = np.stack([waves @ values[2 + n : 2 + 2 * n] for values in tried])
            position[:, 0] += ahead
            for leg in _LEGS:
                thigh, knee = position[:, 2] + position[:, leg.start], position[:, leg.start + 1]
                turns = held_back(ahead.reshape(-1), thigh.reshape(-1), knee.reshape(-1), person)
                position[:, leg] += np.moveaxis(turns.reshape(3, *ahead.shape), 0, 1)
            position[:, 1] += np.stack([heights @ values[2 + 2 * n :] for values in tried])
        return position

    def centre(self, motion: Motion, person: Person, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return where the centres of pressure are expected, shape (n, 2)."""
        return np.clip(motion.pressure_centre + values[1], person.heel, person.toe + _BEYOND_BALL * person.scale)

    def applied(self, motion: Motion, person: Person, values: NDArray[np.float64]) -> Motion:
        """Return the motion with these values."""
        position = np.ascontiguousarray(self._moved(motion, person, values[None])[0].T)
        trial = motion.trial and replace(motion.trial, mean=self.applied(motion.trial.mean, person, values))
        return replace(travelling(motion, position), pressure_centre=self.centre(motion, person, values), trial=trial)

    def along(self, motion: Motion, person: Person, tried: NDArray[np.float64], rows: slice) -> Moving:
        """Return samples of the motion with each of the values, shape (k, m), one behind the other.

        All are differentiated at once, for they are short and many; coordinates that no value changes only once.
        """
        position = self._moved(motion, person, tried)
        changed = list(range(position.shape[1])) if self.heights else [2, 3, 6]
        kept = [j for j in range(position.shape[1]) if j not in changed]
        slope, curvature = (np.empty((len(tried), len(motion.position[rows]), position.shape[1])) for _ in range(2))
        for columns, tables in ((changed, position[:, changed]), (kept, position[:1, kept])):
            if not columns:
                continue
            for out, table in zip((slope, curvature), derivatives(np.moveaxis(tables, 2, 0))):
                out[:, :, columns] = np.moveaxis(table[rows], 1, 0)
        slope[:, :, 0] += motion.advance
        slope[:, :, 1] += motion.climb
        n, rate = position.shape[1], 1.0 / motion.period
        places = np.ascontiguousarray(np.moveaxis(position[:, :, rows], 1, 2)).reshape(-1, n)
        return Moving(places, slope.reshape(-1, n) * rate, curvature.reshape(-1, n) * rate**2)


def reduced(motion: Motion, person: Person, carried: Carried | None = None, uneven: bool = False) -> Motion:
    """Return a motion whose ground force passes through the soles, as nearly as leaning can do it.

    Of a whole trial the mean stride says how to lean; every stride is moved alike.

    Args:
        motion: As recorded or drawn.
        person: Whose body; segments after `machine.anthropometry`.
        carried: What is carried beside the own body.
        uneven: Whether it is not the same left and right.

    Raises:
        ScenarioError: no soles on the ground can hold it.
    """
    walks = motion.advance and not motion.from_rest
    parameters = _Parameters(_UNEVEN if uneven else _WALKING, _HEIGHT) if walks else _Parameters(() if motion.from_rest else _IN_PLACE, ())
    stride = motion if motion.trial is None else motion.trial.mean
    problem = _identity(stride, person, parameters, carried)
    if problem not in _kept:
        if len(_kept) >= _KEPT_MOST:
            _kept.clear()
        _kept[problem] = kept(b"lean" + problem, lambda: _found(stride, person, parameters, carried))
    done = parameters.applied(motion, person, _kept[problem])
    return _over_its_feet(done, person, carried) if motion.from_rest else done


def _identity(stride: Motion, person: Person, parameters: _Parameters, carried: Carried | None) -> bytes:
    """Return a digest of all that `_found` depends on."""
    digest = hashlib.sha256(repr((stride.period, stride.advance, stride.ground, stride.from_rest, person, parameters)).encode())
    for table in (stride.position, stride.slope, stride.curvature, stride.share, stride.pressure_centre, stride.support):
        digest.update(np.ascontiguousarray(table).tobytes())
    digest.update(b"" if carried is None else carried.content)
    return digest.digest()


def _found(stride: Motion, person: Person, parameters: _Parameters, carried: Carried | None) -> NDArray[np.float64]:
    """Return the numbers of `parameters` with which a motion is best held, by damped Gauss-Newton steps."""
    scales = parameters.scales()
    values = np.zeros(len(scales))

    def errors(tried: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.concatenate([_off_balance(stride, parameters, tried, person, carried), tried / scales], axis=1)

    left = errors(values[None])[0]
    for _ in range(_STEPS):
        beside = errors(values + np.diag(scales / 100))
        slopes = np.stack([(one - left) / scale * 100 for one, scale in zip(beside, scales)], axis=1)
        normal = slopes.T @ slopes
        normal[np.diag_indices_from(normal)] *= 1.0 + _DAMPING
        step, gone = -np.linalg.solve(normal, slopes.T @ left), 1.0
        while gone > 0.05:
            tried = errors((values + gone * step)[None])[0]
            if tried @ tried < left @ left:
                break
            gone *= 0.5
        else:
            break
        values, left = values + gone * step, tried
    if np.abs(values / scales).max() > _ABSURD:
        raise ScenarioError(
            "no lean of the trunk lets soles on the ground hold this motion: for a moment the body would weigh nothing; write a lower speed"
        )
    return values


def worn(motion: Motion, person: Person, model: mujoco.MjModel) -> Motion:
    """Return the motion of a wearer with the machine, which has the same angles: `reduced` for all that wearer and machine weigh."""
    data = mujoco.MjData(model)
    position, velocity, acceleration, force = data.qpos, data.qvel, data.qacc, data.qfrc_inverse

    def load(along: Moving) -> NDArray[np.float64]:
        out = np.empty((len(along.position), 3))
        for i, (q, v, a) in enumerate(zip(*along)):
            position[:], velocity[:], acceleration[:] = q, v, a
            mujoco.mj_inverse(model, data)
            out[i] = force[:3]
        return -out

    content = np.empty(mujoco.mj_sizeModel(model), dtype=np.uint8)
    mujoco.mj_saveModel(model, None, content)
    flags = model.opt.disableflags
    model.opt.disableflags = flags | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    try:
        return reduced(motion, person, Carried(load, content.tobytes()), _uneven(model))
    finally:
        model.opt.disableflags = flags


def _uneven(model: mujoco.MjModel) -> bool:
    """Return whether a machine's legs do not weigh the same."""
    mass = {model.body(i).name: float(model.body_mass[i]) for i in range(model.nbody)}
    return any(abs(mass[name] - mass[f"{name[:-1]}r"]) > 1e-9 for name in mass if name.endswith("_l") and f"{name[:-1]}r" in mass)


def with_backpack(motion: Motion, person: Person, place: tuple[float, float], mass: float, inertia: float) -> Motion:
    """Return the motion of a person with a backpack: mass [kg] with its centre at `place` from the hips [m], inertia a kilogram [m^2]."""

    def load(along: Moving) -> NDArray[np.float64]:
        position, acceleration = trunk(along)
        return backpack_wrench(position, acceleration, place, np.full(len(position), mass), inertia)[:, 0]

    return reduced(motion, person, Carried(load, repr((place, mass, inertia)).encode()))


def _off_balance(
    motion: Motion, parameters: _Parameters, tried: NDArray[np.float64], person: Person, carried: Carried | None
) -> NDArray[np.float64]:
    """Return how far moment and aim of the ground's force are from what is expected, in units of what is felt, shape (k, m).

    The k motions are worked out at once, for they are short and many.
    """
    rows, count = slice(0, None, _EVERY), len(tried)
    along = parameters.along(motion, person, tried, rows)
    poses, wrench = body_loads(along, person)
    load = ground_reaction.totals(poses, wrench)
    if carried is not None:
        load = load + carried.load(along)
    share, support = np.tile(motion.share[rows], (count, 1)), motion.support[rows]
    centre = np.concatenate([parameters.centre(motion, person, values)[rows] for values in tried])
    off = ground_reaction.off_balance(poses, load, share, centre, person, motion.ground.angle)
    return _felt(motion, load[:, 1].reshape(count, -1), off.reshape(count, -1, 2), support / np.sqrt(len(support)))


def _felt(
    motion: Motion, up: NDArray[np.float64], off: NDArray[np.float64], felt: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return `_off_balance` for loads upward, shape (k, n), and what is amiss, (k, n, 2)."""
    weight = -np.mean(up, axis=1, keepdims=True)
    out = [off[:, :, 0] * felt / (weight * _LEVER)]
    if motion.advance and not motion.from_rest:
        jerky = np.fft.rfft(up, axis=1)[:, 6:20] * 2 / up.shape[1] / (weight * _JERK)
        out += [off[:, :, 1] * felt / (weight * _AIM), jerky.real, jerky.imag]
    return np.concatenate(out, axis=1)


def _over_its_feet(motion: Motion, person: Person, carried: Carried | None) -> Motion:
    """Return a motion that begins at rest with the pelvis ahead or back so that the ground's force passes where it is expected.

    The body's pendulum says by how much (Kajita and others 2003, as in `start_and_stop`); feet and trunk stay as they are.
    """
    for _ in range(_ROUNDS):
        along = Moving.of(motion)
        poses, wrench = body_loads(along, person)
        load = ground_reaction.totals(poses, wrench)
        if carried is not None:
            load = load + carried.load(along)
        off = ground_reaction.off_balance(poses, load, motion.share, motion.pressure_centre, person)[:, 0] / float(np.mean(-load[:, 1]))
        motion = with_pelvis_ahead(motion, person, -pendulum.above(off, _MASS_HEIGHT * person.height, motion.period))
    return motion


def _basis(phase: NDArray[np.float64], harmonics: tuple[int, ...]) -> NDArray[np.float64]:
    """Return cosines and sines of these harmonics, shape (n, 2 harmonics): asked hundreds of times of the same phases."""
    return _waves(np.ascontiguousarray(phase).tobytes(), harmonics)


@lru_cache(maxsize=8)
def _waves(phase: bytes, harmonics: tuple[int, ...]) -> NDArray[np.float64]:
    at = np.frombuffer(phase)
    waves = np.reshape([wave(2 * np.pi * h * at) for h in harmonics for wave in (np.cos, np.sin)], (-1, len(at))).T
    waves.flags.writeable = False
    return waves
