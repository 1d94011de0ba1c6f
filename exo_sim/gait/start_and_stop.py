"""Walking off from stance and coming to rest: six steps of a recorded walk between two times of standing still.

Feet do what they do in the recorded walk, in steps that are half as long first and last. The centre of pressure goes back to the heels
before the first step, as in people (Breniere and Do 1986, "When and how does steady state gait movement induced from upright posture
begin?", Journal of Biomechanics 19:1035-1040), in steps it goes from heel to ball, and in the last one it is early at the ball, which
brakes. The pelvis goes over these points as a pendulum does that begins and ends at rest (`pendulum.above`; after Kajita and others 2003,
"Biped walking pattern generation by using preview control of zero-moment point", IEEE International Conference on Robotics and Automation,
1620-1626); what the recorded pelvis does beside that is added as walking sets in. None of it was recorded.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.gait import pendulum, recorded_gait
from exo_sim.gait.footpaths import Paths, bowed, paths, reach, rolling, walked
from exo_sim.gait.motion import SAMPLES, Motion, phases, smooth, travelling
from exo_sim.gait.walking import contacts, loaded, pressure_centres, walking
from exo_sim.machine.ground import LEVEL
from exo_sim.machine.person import Person

Array = NDArray[np.float64]

#: Strides of time in a cycle, and the phase of the right foot's stride at which it begins: a little more than one of them is stance.
STRIDES, _BEGINS = 5, -0.75
#: A foot lies flat on the ground at this phase of its stride: there its strides become longer or shorter.
_FLAT = 0.25
#: Length of the strides of each foot over the recorded one, left and right, and the phase of its own stride from which on it strides.
_LENGTHS, _FIRST = ((1.0, 1.0, 0.5), (0.5, 1.0, 1.0)), (1.25, 0.25)
#: In a short stride a foot is lifted less, by this power of its length.
_LIFT = 0.5
#: Right foot's phases over which walking sets in and ends, and the centre of pressure goes back to the heels and comes to rest.
_SETS_IN, _ENDS, _BACK, _TO_REST = (0.25, 1.25), (2.75, 3.75), (-0.1, 0.45), (3.5, 4.0)
#: The right foot is unloaded over these phases of its first stride; in its last stance the pressure is at the ball by the second.
_UNLOADED, _BRAKES = (0.30, 0.62), (3.06, 3.22)
#: Height of the mass above the ground over the body's height (Winter 2009, table 4.1: hips to head about 0.56).
_MASS_HEIGHT = 0.56
#: Harmonics of a stride that are kept.
_HARMONICS = 12
#: Knees are bent by so much in stance [rad].
_KNEE = math.radians(15.0)


def start_and_stop(name: str, person: Person) -> Motion:
    """Return a cycle that begins in stance, takes six steps and comes to rest where the next one begins.

    Args:
        name: Of the recorded gait.
        person: Who walks.

    Raises:
        ScenarioError: no gait of this name was recorded.
    """
    mean, stance_end = walking(name, person), recorded_gait.load(name).stance_end
    it = paths(mean, person)
    phase = _BEGINS + np.arange(STRIDES * SAMPLES) / SAMPLES
    own = np.stack([phase + 0.5, phase], axis=1)
    # a foot that stands still stays in the posture in which it is flat
    of_foot = np.stack([np.where(own[:, i] < begun, _FLAT, np.where(own[:, i] >= begun + 3.0, _FLAT, own[:, i] % 1.0))
                        for i, begun in enumerate(_FIRST)], axis=1)  # fmt: skip
    walks = smooth((phase - _SETS_IN[0]) / (_SETS_IN[1] - _SETS_IN[0])) * smooth((_ENDS[1] - phase) / (_ENDS[1] - _ENDS[0]))
    share = _shares(phase, of_foot, stance_end)
    centre = _centres(phase, of_foot, stance_end, person)
    feet = [_foot(it, mean.advance, own[:, i], walks, i) for i in range(2)]
    ahead, up, pitch = (np.stack([foot[k] for foot in feet], axis=1) for k in range(3))
    advance = mean.advance * sum(_LENGTHS[0])
    drawn = Paths(_pelvis(it, mean, person, phase, walks, (share * (ahead + centre)).sum(axis=1), advance),
                  _eased(it.trunk, phase, walks), ahead, up, pitch, rolling(of_foot))  # fmt: skip
    drawn = bowed(drawn, person, LEVEL, reach(it, person, LEVEL))
    like = replace(
        mean, share=share, pressure_centre=centre, contact=contacts(of_foot[:, 0], of_foot[:, 1], stance_end), support=np.ones(len(phase)),
        from_rest=True,
    )  # fmt: skip
    motion = walked(drawn, like, person, LEVEL, advance, STRIDES * mean.period)
    return _without_edges(motion)


def _shares(phase: Array, of_foot: Array, stance_end: float) -> Array:
    """Return how much each foot carries, shape (n, 2)."""
    weight = loaded(of_foot, stance_end)
    first = phase < _FIRST[1] + 0.5
    weight[first, 1] = smooth((_UNLOADED[1] - phase[first]) / (_UNLOADED[1] - _UNLOADED[0]))
    return np.asarray(weight / weight.sum(axis=1, keepdims=True))


def _centres(phase: Array, of_foot: Array, stance_end: float, person: Person) -> Array:
    """Return where the centre of pressure of each foot is, ahead of the ankle along the sole [m], shape (n, 2)."""
    rests, heel, ball = 0.5 * (person.heel + person.toe), person.heel, person.toe
    centre = pressure_centres(of_foot[:, 0], of_foot[:, 1], stance_end, person)
    back = rests + (heel - rests) * smooth((phase - _BACK[0]) / (_BACK[1] - _BACK[0]))
    to_rest = smooth((phase - _TO_REST[0]) / (_TO_REST[1] - _TO_REST[0]))
    brakes = heel + (ball - heel) * smooth((phase - _BRAKES[0]) / (_BRAKES[1] - _BRAKES[0]))
    centre[:, 0] = np.where(phase < 0.5, back, np.where(phase < 3.25, centre[:, 0], rests))
    centre[:, 1] = np.where(phase < 0.8, back, np.where(phase < 3.0, centre[:, 1], brakes + (rests - brakes) * to_rest))
    return centre


def _foot(it: Paths, stride: float, own: Array, walks: Array, foot: int) -> tuple[Array, Array, Array]:
    """Return where a foot is along the ground, the height of the point that bears [m], and its pitch [rad], shape (n,) each.

    Args:
        it: Of the recorded walk; `stride` is its length [m].
        own: Phase of the foot's own stride, counted on.
        walks: How far walking has set in.
        foot: 0 for the left one, 1 for the right one.
    """
    grid = np.arange(2 * SAMPLES) / SAMPLES
    since = own - _FIRST[foot]
    number = np.clip(np.floor(since), -1, 3).astype(int)
    lengths = np.array([*_LENGTHS[foot], 0.0, 0.0])[number]  # before the first stride and behind the last there is none
    before = np.array([0.0, *np.cumsum(_LENGTHS[foot]), 0.0])[number]
    through = np.where(lengths > 0.0, since - number, 0.0)
    of_right = {name: np.tile(getattr(it, name)[:, 1], 2) for name in ("ahead", "up", "pitch")}
    of_right["ahead"][SAMPLES:] += stride

    def at(name: str, through: Array | float) -> Array:
        return np.interp(_FLAT + through, grid, of_right[name])

    ahead = stride * before + lengths * (at("ahead", through) - at("ahead", 0.0))
    up = walks * at("up", 0.0) + lengths**_LIFT * (at("up", through) - at("up", 0.0))
    pitch = walks * at("pitch", 0.0) + lengths * (at("pitch", through) - at("pitch", 0.0))
    return ahead, up, pitch


def _pelvis(it: Paths, mean: Motion, person: Person, phase: Array, walks: Array, centre: Array, advance: float) -> Array:
    """Return where the pelvis is [m], shape (n, 2), for a centre of pressure along the ground [m], shape (n,)."""
    height = _MASS_HEIGHT * person.height
    steady, whole = mean.advance * phases(), advance * np.arange(len(phase)) / len(phase)
    usual = (mean.share * (it.ahead + mean.pressure_centre)).sum(axis=1) - steady
    beside = it.pelvis[:, 0] - steady - pendulum.above(usual, height, mean.period)
    ahead = whole + pendulum.above(centre - whole, height, STRIDES * mean.period) + _eased(beside, phase, walks)
    up = (1.0 - walks) * _standing(person) + walks * np.interp(phase % 1.0, phases(), it.pelvis[:, 1], period=1.0)
    return np.stack([ahead, up], axis=1)


def _standing(person: Person) -> float:
    """Return how high the hips are above the ground in stance, knees a little bent [m]."""
    leg = math.sqrt(person.thigh**2 + person.shank**2 + 2.0 * person.thigh * person.shank * math.cos(_KNEE))
    return person.ankle_height + leg


def _eased(values: Array, phase: Array, walks: Array) -> Array:
    """Return values of the mean stride at other phases, their mean where nobody walks."""
    middle = float(values.mean())
    return np.asarray(middle + walks * (np.interp(phase % 1.0, np.arange(SAMPLES + 1) / SAMPLES, np.append(values, values[0])) - middle))


def _without_edges(motion: Motion) -> Motion:
    """Return a motion without what is faster than some harmonics of a stride."""
    spectrum = np.fft.rfft(motion.position, axis=0)
    spectrum[_HARMONICS * STRIDES + 1 :] = 0.0
    return travelling(motion, np.fft.irfft(spectrum, len(motion.position), axis=0))
