"""Sensors that stop: stuck at one reading while things move, cut off at the end of their range, never moving at all.

Five kinds of evidence are accepted, none of which a machine at rest or against its stop gives:

- the sensor shows noise finer than or near its step elsewhere, and a long run of one exact reading is then next to
  impossible (chance below one in a million for the whole recording);
- it is on a grid coarser than its noise, or free of noise, and leaves the run by a jump far larger than it ever makes
  between two samples while other signals move meanwhile (stuck);
- it runs at full speed into its own extreme, again and again, and stays there exactly (clipped; not for positions,
  whose machine has end stops);
- its noise is above its step where it moves slowly, and it repeats elsewhere by chance only, but at its extreme for longer than
  that noise lets it (clipped; a piston that rests at a stop shows the noise there too, and an encoder without noise has none
  where it moves slowly);
- a chamber's pressure is one number from first to last while its valve is worked, or while the piston moves and the other
  chamber's pressure swings.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from exo_sim.recording.columns import signal_of
from exo_sim.recording.data_quality_finding import Finding
from exo_sim.recording.health.facts import Facts
from exo_sim.recording.health.spans import Rows, listed, runs, where
from exo_sim.recording.noise import Noise
from exo_sim.recording.table import Recording
from exo_sim.signals import VALVE_COMMANDS

#: Signals whose flat spans mean something else: commands are held, nobody pushes.
_FLAT_BY_NATURE = (*VALVE_COMMANDS, "external_force")
_FORCES = ("ground_force_", "strap_force_", "force", "pressure_centre")
_CHANCE = 1e-6
_FEWEST = 20
#: A column of so few readings, neighbouring steps of its converter, shows its rounding and not whether it stops.
_FEW_READINGS = 4
#: Share of the samples that counts as slow; noise below this share of the range is rounding; share of rows that repeat for other reasons.
_SLOWEST, _LEAST, _SELDOM = 0.3, 1e-5, 1e-3
#: Share of neighbouring fourth differences of opposite sign: 0.80 of white noise.
_TURNS = 0.6
#: A valve is worked whose command changes by so much; a pressure swings that changes by this share of its greatest.
_WORKED, _SWINGS = 0.1, 0.1
#: Seconds between samples up to which a corner in a curve is seen as one.
_QUICK = 0.01


def check(recording: Recording, key: str, noise: Mapping[str, Noise], facts: Facts | None = None) -> list[Finding]:
    """Look for spans in which one column stands still; of a machine of which no `facts` are known no chamber is taken for vented."""
    values = recording[key]
    signal = key.rsplit(".", 1)[-1]
    present = values[np.isfinite(values)]
    if len(present) < 2 * _FEWEST or not signal_of(key).measured:  # what only a simulation knows has no sensor
        return []
    if np.all(present == present[0]):
        return _constant(recording, key, float(present[0]), facts or Facts(), noise)
    if signal in _FLAT_BY_NATURE or len(np.unique(present)) <= _FEW_READINGS:
        return []
    held = runs(np.diff(values) == 0.0)
    held[:, 1] += 1  # a run of n equal differences spans n + 1 samples
    if signal.startswith(_FORCES):
        held = held[values[held[:, 0]] != 0.0]
    if not len(held):
        return []
    longest = _longest_by_chance(values, held, noise[key])
    quick = float(np.median(np.diff(recording.time))) < 1.01 * _QUICK
    dithers = noise[key].white > 0.5 * noise[key].step and _turns_often(present) and (quick or noise[key].step == 0.0)
    long = held[held[:, 1] - held[:, 0] >= (longest if dithers else _FEWEST)]
    low, high = float(present.min()), float(present.max())
    at_end = (values[held[:, 0]] == low) | (values[held[:, 0]] == high)
    rough = None if dithers else _rough(values, held, at_end, noise[key])
    clipped = _clipped(values, held[at_end], dithers or rough is not None, rough or longest, noise[key], quick and signal != "position")
    if len(clipped):
        return _say_clipped(recording, key, clipped)
    if not dithers:
        long = _released_by_a_jump(recording, key, values, long, noise)
    return _say_stuck(recording, key, long) if len(long) else []


def _constant(recording: Recording, key: str, value: float, facts: Facts, noise: Mapping[str, Noise]) -> list[Finding]:
    unit = recording.units.get(key, "1")
    signal = key.rsplit(".", 1)[-1]
    says = f'"{key}" reads exactly {value:.6g}{"" if unit == "1" else " " + unit} from first to last'
    grave = (
        unit in ("Pa", "K")
        and signal != "temperature"
        and not key.startswith(("supply.", "exhaust."))
    )
    if unit == "Pa" and value > 0.0 and key not in facts.vented and (why := _is_worked(recording, key, value, facts, noise)):
        return [Finding(key, "constant", f"{says}, while {why}: no sensor that works", severity="fault", use="set aside")]
    if not grave or value > 0.0:
        return [Finding(key, "constant", says, severity="info")]
    return [Finding(key, "constant", says + ": a dead sensor", severity="fault", use="set aside")]


def _is_worked(recording: Recording, key: str, value: float, facts: Facts, noise: Mapping[str, Noise]) -> str:
    """Return what makes the pressure of a chamber change, "" where nothing that was recorded does."""
    part, signal = key.rsplit(".", 1)
    if signal not in ("pressure_1", "pressure_2"):
        return ""
    commands = [values for command in VALVE_COMMANDS if (values := recording.get(f"{part}.{command}")) is not None]
    if any(np.isfinite(one).any() and np.nanmax(one) - np.nanmin(one) > _WORKED for one in commands):
        return "its valve is worked"
    if abs(value - facts.atmosphere) < _SWINGS * facts.atmosphere:  # left open, as whoever wrote the column knows
        return ""
    other = f"{part}.pressure_{2 if signal.endswith('1') else 1}"
    beside = recording.columns.get(other, np.full(1, np.nan))
    swings = _range(beside) > (max(_SWINGS * float(np.nanmax(beside)), 12.0 * noise[other].std) if np.isfinite(beside).any() else 0.0)
    places = {name: values for name, values in recording.columns.items() if name.endswith(".position")}
    moves = any(_range(values) > max(12.0 * noise[name].std, 1e-3) for name, values in places.items())
    return f'"{other}" swings and the machine moves' if swings and moves else ""


def _range(values: NDArray[np.float64]) -> float:
    return float(np.nanmax(values) - np.nanmin(values)) if np.isfinite(values).any() else 0.0


def _rough(values: NDArray[np.float64], held: Rows, at_end: NDArray[np.bool_], noise: Noise) -> int | None:
    """Return how long a run of equal readings must be for noise not to leave it by chance, None where noise is too small to say.

    What moves slowly and does not stand tells that noise: a machine that shakes, or a clock that is uneven, makes some of quick motion.

    Args:
        values: Shape (n,).
        held: Runs of equal readings, `at_end` which of them are at an extreme.
        noise: Of the column.
    """
    standing = np.zeros(len(values), dtype=bool)
    for begin, end in held[at_end]:
        standing[begin:end] = True
    fine = np.diff(values, 4) / math.sqrt(70.0)  # of white noise four of five change their sign, of motion hardly any
    good = np.isfinite(fine) & ~standing[4:] & ~standing[:-4]
    if good.sum() <= 5 * _FEWEST:
        return None
    way = np.abs(values[4:] - values[:-4])
    slow = good & (way <= np.quantile(way[good], _SLOWEST))
    level, fine = 1.4826 * float(np.median(np.abs(fine[slow]))), fine[good]
    readings = np.unique(values[np.isfinite(values)])
    step = max(noise.step, float(np.quantile(np.diff(readings), 0.1)))  # also one that no grid tells of
    turns = float(np.mean(fine[1:] * fine[:-1] < 0.0))
    if level <= max(step, _LEAST * _range(values)) or turns < _TURNS:
        return None
    again = math.erf(step / (math.sqrt(8.0) * level))
    if float((held[~at_end, 1] - held[~at_end, 0] - 1).sum()) > (again + _SELDOM) * len(values):  # it rests elsewhere as quietly
        return None
    return max(_FEWEST, 1 + math.ceil(math.log(_CHANCE / len(values)) / math.log(max(again, 1e-3))))


def _turns_often(values: NDArray[np.float64]) -> bool:
    """Return True where readings go up and down like noise: white noise turns at 2 of 3 samples, motion hardly ever."""
    steps = np.diff(values)
    steps = steps[steps != 0.0]
    return len(steps) > _FEWEST and bool(np.mean(steps[1:] * steps[:-1] < 0.0) > 0.3)


def _longest_by_chance(values: NDArray[np.float64], held: Rows, noise: Noise) -> int:
    """Return the length that a run of equal readings reaches with a chance of `_CHANCE` in the whole recording.

    Readings repeat the more often the slower things move, most of all at rest in the middle of a step of the sensor.
    """
    lengths = held[:, 1] - held[:, 0]
    ordinary = lengths < 5 * _FEWEST
    repeats = float((lengths[ordinary] - 1).sum())
    others = max(1.0, len(values) - float(lengths[~ordinary].sum()))
    unrounded = math.sqrt(max(noise.white**2 - noise.step**2 / 12.0, 1e-12 * noise.white**2))
    at_rest = math.erf(noise.step / (math.sqrt(8.0) * unrounded)) if unrounded > 0.0 else 0.0
    again = min(0.98, max(repeats / others, at_rest, 1e-3))
    return max(_FEWEST, 1 + int(np.ceil(np.log(_CHANCE / len(values)) / np.log(again))))


def _clipped(
    values: NDArray[np.float64], spans: Rows, dithers: bool, longest: int, noise: Noise, corners: bool
) -> Rows:
    """Return the spans at an extreme in which the sensor, not the machine, is at its end."""
    if not len(spans):
        return spans
    lengths = spans[:, 1] - spans[:, 0]
    if dithers:
        some = spans[lengths >= 5]
        return some if len(some) and (lengths.max() >= longest or len(some) >= 8) else spans[:0]
    if not corners:
        return spans[:0]
    inner = spans[(spans[:, 0] >= 3) & (spans[:, 1] <= len(values) - 3) & (lengths >= 5)]
    # a curve that is cut off arrives at full speed; one that settles has slowed down before
    last = np.abs(values[inner[:, 0] - 1] - values[inner[:, 0] - 2])
    before = np.abs(values[inner[:, 0] - 2] - values[inner[:, 0] - 3])
    least = max(4.0 * noise.step, 1e-3 * float(np.nanmax(values) - np.nanmin(values)))
    cut = (last > least) & (last > 0.8 * before)
    return inner[cut] if cut.sum() >= 3 and cut.mean() > 0.5 else inner[:0]


def _released_by_a_jump(
    recording: Recording, key: str, values: NDArray[np.float64], spans: Rows, noise: Mapping[str, Noise]
) -> Rows:
    if not len(spans):
        return spans
    inside = np.zeros(len(values), dtype=bool)
    ends = []
    for start, stop in spans:
        inside[start:stop] = True
        ends.append(abs(values[stop] - values[stop - 1]) if stop < len(values) else 0.0)
    steps = np.abs(np.diff(values))
    ordinary = steps[~(inside[1:] | inside[:-1])]
    ordinary = ordinary[np.isfinite(ordinary)]
    usual = float(ordinary.max()) if len(ordinary) else np.inf
    jumped = np.array(ends) > max(2.0 * usual, 20.0 * noise[key].std)
    spreads = {other: float(np.nanmax(whole) - np.nanmin(whole)) for other, whole in recording.columns.items() if np.isfinite(whole).any()}
    spreads.pop(key)
    moving = [_others_move(recording, spreads, int(start), int(stop), noise) for start, stop in spans[jumped]]
    return spans[jumped][np.array(moving, dtype=bool)]


def _others_move(recording: Recording, spreads: Mapping[str, float], start: int, stop: int, noise: Mapping[str, Noise]) -> bool:
    """Return whether any of these columns moves in a span; `spreads` says between which ends each does in the whole recording."""
    for other, spread in spreads.items():
        piece = recording[other][start:stop]
        piece = piece[np.isfinite(piece)]
        if len(piece) > 1 and spread > 0.0 and np.ptp(piece) > max(0.02 * spread, 12.0 * noise[other].std):
            return True
    return False


def _say_clipped(recording: Recording, key: str, spans: Rows) -> list[Finding]:
    values, unit = recording[key], recording.units.get(key, "")
    ends = {float(values[start]) for start, _ in spans}
    limit = " and ".join(f"{end:.6g} {unit}" for end in sorted(ends))
    rows, times = listed(spans, recording.time)
    says = f'"{key}" is cut off at {limit}, the end of what its sensor shows, {where(spans, recording.time)}'
    return [Finding(key, "clipped", says, rows, times, severity="fault", use="set aside")]


def _say_stuck(recording: Recording, key: str, spans: Rows) -> list[Finding]:
    value, unit = float(recording[key][spans[0][0]]), recording.units.get(key, "")
    rows, times = listed(spans, recording.time)
    says = f'"{key}" is stuck at exactly {value:.6g} {unit} while other things move, {where(spans, recording.time)}'
    return [Finding(key, "stuck", says, rows, times, severity="fault", use="set aside")]
