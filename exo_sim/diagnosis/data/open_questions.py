"""The questions that recordings may leave open."""

from __future__ import annotations

from dataclasses import dataclass

from exo_sim.diagnosis.findings import OpenQuestion
from exo_sim.physics.declaration import declared

#: What a question is about where it is about every effect of a balance, in words.
_GAS, _FORCES = "gas and valve effects", "friction, load and joint effects"


@dataclass(frozen=True)
class Unjudged:
    """Why a balance cannot be judged, and what to do about it."""

    why: str
    do: str = "record the missing signal as well"


def _about(cut: str) -> tuple[str, ...]:
    """Return the names of all effects on "gas", or on "motion", that a diagnosis asks for."""
    return tuple(name for name, effect in declared().items() if effect.cut == cut and not effect.identification.excluded)


def of_gas(cylinder: str, recording: str, unjudged: Unjudged) -> OpenQuestion:
    """Return the question that the pressures of a cylinder would answer."""
    return OpenQuestion(f"the gas of {cylinder} in {recording}", _about("gas"), unjudged.why, unjudged.do, _GAS)


def of_balance(joint: str, recording: str, unjudged: Unjudged) -> OpenQuestion:
    """Return the question that a balance of forces would answer."""
    return OpenQuestion(f"the balance of forces at {joint} in {recording}", _about("motion"), unjudged.why, unjudged.do, _FORCES)


def of_pressures_behind_hose(joint: str, recording: str) -> OpenQuestion:
    """Return the question that a balance of forces would answer whose pressures were recorded behind hoses that nobody understands."""
    why = "its pressures were recorded behind hoses in which something without a name acts: nobody knows those in the chambers"
    return of_balance(joint, recording, Unjudged(why, "record the pressures at the cylinder itself"))


def of_remainder(where: str) -> OpenQuestion:
    """Return the question what remains in a balance of forces one of whose pressures was not measured."""
    why = "it does not close, and one of its pressures was not recorded: the chamber may be at fault"
    return OpenQuestion(f"the rest of the balance of forces of {where}", _about("motion"), why, called=_FORCES)


def of_quick_motion(joint: str, recording: str, seconds: float) -> OpenQuestion:
    """Return the question that a balance of forces would answer of a joint that turns round sooner than its forces are averaged [s]."""
    why = f"it hardly ever moves one way for the {seconds:.2g} s over which forces are averaged"
    do = f"move it more slowly as well, some seconds of strokes that take {4.0 * seconds:.1g} s or more each"
    return OpenQuestion(f"the balance of forces at {joint} in {recording}", _about("motion"), why, do, _FORCES)


def of_little_motion(joint: str, recording: str, rows: int, fewest: int, seconds: float) -> OpenQuestion:
    """Return the same of a joint that moves one way for so many times over which forces are averaged [s], where no fewer are needed."""
    why = f"of all that may be fitted it moves one way, clear of noise, for {rows} times {seconds:.2g} s, and {fewest} are needed"
    return OpenQuestion(f"the balance of forces at {joint} in {recording}", _about("motion"), why, "record more of its motion", _FORCES)


def of_undecided(effect: str, called: str, where: str, do: str) -> OpenQuestion:
    """Return the question whether an effect acts that numbers of the rig and its sensors, within their data sheets, stand in for.

    Args:
        effect: Its name, as in the table of effects.
        called: The same in words.
        where: The part.
        do: What shows it.
    """
    why = "it is probable, but masses and sensors that are off within what data sheets allow explain this recording as well"
    return OpenQuestion(f"whether there is {called} at {where}", (effect,), why, do)


def of_free_swing(joint: str, off: float, spread: float) -> OpenQuestion:
    """Return the question why a joint that nothing drives swings otherwise than its rig, by so much of what it moves."""
    why = f"run free it is {100.0 * off / spread:.2g} % of its motion off, and its forces show nothing but the noise of the position"
    do = "record its position with less noise or more often, and let it swing until it rests"
    return OpenQuestion(f"what makes {joint} swing otherwise than the rig", _about("motion"), why, do, _FORCES)


def of_rate(where: str, rate: float, effects: tuple[str, ...], called: str, enough: float) -> OpenQuestion:
    """Return the question whether effects act that so many samples a second [Hz] do not show where they are small.

    Args:
        where: The part.
        rate: Of the recording [Hz].
        effects: Their names.
        called: The same in words.
        enough: The rate to record at [Hz].
    """
    why = f"{rate:.3g} samples a second leave open what the valve was told between them, and hide {called} as small as they often are"
    return OpenQuestion(f"whether small gas and valve effects act at {where}", effects, why, f"record at {enough:g} Hz or more")
