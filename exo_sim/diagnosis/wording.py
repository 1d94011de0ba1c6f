"""Sentences for people: what was found, why a rival was rejected, what to record next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.nominal_numbers import DEAD_VOLUME, FLOW_CAPACITY, PAYLOAD_MASS
from exo_sim.diagnosis.policy.verdicts import FAR_WORSE, HALF_EXPLAINED, NOTHING_EXPLAINED
from exo_sim.physics.declaration import declared

#: What a number may stand for that is further off than any data sheet allows.
STANDS_FOR = {
    DEAD_VOLUME: "a hose, a tank or volume that nobody counted, or a number that is wrong",
    FLOW_CAPACITY: "something that throttles beside the valve, another valve or another gas, or a number that is wrong",
}

#: Why an effect was left out that stands only beside numbers that are further off with it.
STRAINING = "with it numbers of the rig are further off than without, and no more is left without it than a healthy machine leaves"


def name_of(effect: str) -> str:
    """Return an effect's name in words."""
    return effect.replace("_", " ").replace("coulomb", "Coulomb").replace("stribeck", "Stribeck")


def says(effect: str) -> str:
    """Return the sentence that an effect declares, or one made of its name."""
    found = declared().get(effect)
    return found.says if found else f"{name_of(effect).capitalize()}."


def calibration(name: str, parameter: str, factor: float) -> str:
    """Return how a nominal number is off."""
    part = {
        "valve_area": "valve area",
        "dead_volume_1": "dead volume of chamber 1",
        "dead_volume_2": "dead volume of chamber 2",
    }
    if name in declared():
        what = f"{name_of(parameter)} of the {name_of(name)} that the rig has"
        return f"The {what} is {more_or_less(factor, 0)} than nominal."
    what = {PAYLOAD_MASS: "moved mass"}.get(name, part.get(parameter, name_of(name)))
    return f"The {what} is {more_or_less(factor)} than nominal."


def beyond_data_sheet(name: str, rivals: Sequence[str]) -> str:
    """Return what a number may stand for that is further off than any data sheet allows; `rivals` are effects that explain as much."""
    explained = f"{' or '.join(map(name_of, rivals))} would explain as much" if rivals else "no effect on the list explains it as well"
    return f"No data sheet leaves so much open, and {explained}: {STANDS_FOR[name]}."


def set_by_laws(ends: Mapping[str, Sequence[str]]) -> str:
    """Return that ends of intervals, by parameter "lower", "upper" or both, are those of other laws."""
    listed = " and ".join(f"the {' and the '.join(of)} end of the interval of {name_of(parameter)}" for parameter, of in ends.items())
    return f"Other laws explain this recording as well, and set {listed}."


def counted_in(effect: str) -> str:
    """Return what a number is smaller by where its owner counted an effect in."""
    return f"That is about what the {name_of(effect)} beside it holds: it was counted in."


def warm_hose() -> str:
    """Return what may make a dead volume look larger that holds a hose which nobody described."""
    return (
        "Gas in a hose that stays as warm as the room answers like up to 1.4 times its volume: hoses that are counted among the dead "
        "volumes make them look larger by that."
    )


def twins(effects: Sequence[str]) -> str:
    """Return that effects would look the same as a number that is off."""
    return f"In these recordings {' or '.join(map(name_of, effects))} of the force that was measured would look the same."


def rejected(candidate: Candidate, instead_of: Candidate, worse: float) -> str:
    """Return why a rival was rejected, whose log-likelihood is `worse` lower."""
    how = "far worse" if worse > FAR_WORSE else "worse"
    if candidate.effect == instead_of.effect:
        return f"in the form {name_of(candidate.form)} it fits {how}"
    return f"in place of {name_of(instead_of.effect)} it fits {how}"


def no_gain(candidate: Candidate, share: float) -> str:
    """Return why a candidate was not added."""
    if share <= NOTHING_EXPLAINED:
        return "it explains nothing of what is left"
    if share < HALF_EXPLAINED:
        return f"it explains only {100 * share:.0f} % of what is left, no more than a healthy machine shows"
    return "what is left is as small as a healthy machine's, and adding it does not lower it steadily"


def unsure_beside_unknown(share: float) -> str:
    """Return why a candidate does not stand beside something without a name; `share` is what it explains of what is missing."""
    return (
        f"beside something without a name it explains {100 * share:.0f} % of what is missing, "
        "and time that no number was fitted to does not surely bear it out"
    )


def small(effect: str, is_nominal: bool) -> str:
    """Return what is said of an effect, or of a number of the rig (`is_nominal`), that shows beyond doubt but is too small to matter."""
    what = f"{name_of(effect)} other than nominal" if is_nominal else name_of(effect)
    return f"{what[0].upper()}{what[1:]}: the data show it beyond doubt, but no more of it than healthy machines have."


def unsure(effect: str) -> str:
    """Return what is said of an effect that is not certain, of which healthy machines have as much."""
    what = name_of(effect)
    return f"{what[0].upper()}{what[1:]}: the data do not show it surely, and no more of it than healthy machines have."


def rest(share: float, error: float, noise: float, unit: str) -> str:
    """Return how much is left without a name.

    Args:
        share: Of the squared error that there was to explain.
        error, noise: Root mean square of what is left, and what sensors alone would leave, in `unit`.
    """
    part = "all" if share > 0.995 else f"{100.0 * share:.2g} %"
    often = f", {_rounded(error / noise, 2)} times what the sensors' noise leaves" if noise > 0.0 else ""
    return f"It is {part} of the error that there was to explain: {_rounded(error, 3)} {unit}{often}."


def _rounded(value: float, digits: int) -> str:
    """Return a number with so many digits, without a power of ten below a million."""
    return f"{float(f'{value:.{digits}g}'):g}"


def varies(acts: str, variables: Sequence[str], share: float, is_told_apart: bool) -> str:
    """Return what varies with signals and has no name: a force, which does not turn with the motion, or a friction, which does.

    Args:
        acts: "force" or "friction", whichever follows the signals more closely.
        variables: The signals.
        share: Its root mean square, of all friction that acts.
        is_told_apart: Whether the recordings tell the two apart.
    """
    with_what = f"varies with {' and '.join(variables)} by {100.0 * share:.0f} % of all that acts"
    if not is_told_apart:
        return f"A force or a friction {with_what}: which of the two, these recordings do not tell."
    if acts == "force":
        return f"A force {with_what}. It does not turn with the direction of motion, as friction would."
    return f"Friction {with_what}. It turns with the direction of motion, as no force would."


def more_or_less(factor: float, decimals: int = 1) -> str:
    """Return by how much a number is off."""
    return f"{abs(factor - 1.0) * 100:.{decimals}f} % {'larger' if factor > 1.0 else 'smaller'}"


def curve(signal: str, explains: float | None, is_followed: bool, is_told_apart: bool = True) -> str:
    """Return what a curve over a signal is worth, and why the improved rig holds none where it does not.

    Args:
        signal: The column that it depends on.
        explains: Share of the variance of what is missing that it predicts where it was not fitted; None where that is too little.
        is_followed: Whether a simulated machine can follow that signal.
        is_told_apart: Whether it is known to be a force, or a friction: taken for the other it would drive a machine astray.
    """
    if explains is None:
        return f"No curve over {signal} predicts enough of it to be put into improved.toml."
    predicts = f"A curve over {signal} predicts {100.0 * explains:.0f} % of its variance"
    if not is_followed:
        return f"{predicts}, but no rig can follow {signal}: improved.toml does without."
    return f"{predicts}." if is_told_apart else f"{predicts}; improved.toml does without, for it may be either."


def experiment(first: str, second: str) -> str:
    """Return the experiment that separates two effects: that of the one that is mistaken for fewer others."""
    known = [effect for name, effect in declared().items() if name in (first, second)]
    if known:
        return min(known, key=lambda effect: (len(effect.mistaken_for), effect.name != first)).experiment
    return "record the same motion once more with every sensor calibrated"
