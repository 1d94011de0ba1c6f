"""The machines of `../shared/data`, each as a case, and cases cut down from them.

What is known of each comes from the readmes of that folder and the publications named there; where nobody published the error of an
honest model on what is held out here, `honest` computes it (plain least squares, no code shared with the simulator).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from exo_sim.errors import RecordingError, TrialError
from exo_sim.recording import Recording, read
from exo_sim.recording.foreign import emps, gas_spring, pendulum, seals
from exo_sim.trials.real.case import BALANCE, FREE_RUN, TAIL, Known, Moving, Name, RealCase
from exo_sim.trials.real.cut_down import ends, first, halved, rest, thinned, with_given

#: Share of a lone recording that the tool gets.
GIVEN = 0.7
#: Seconds of a pressure's decay that the tool gets: three quarters of the gas are gone by then.
DECAY_GIVEN = 60.0
#: When the supply of the leaking chamber was shut [s]: its pressure begins to fall.
SHUT = 7.44

SLIDING = Moving(cut_off=5.0, speed=3e-4)
POSITIONING = Moving(cut_off=60.0, speed=1e-3)
STROKES = Moving(cut_off=5.0, speed=5e-3, acceleration=0.2)

#: Makes of rig.
DRIVE, PENDULUM, SPRING, PISTON, LIFT = "linear drive", "pendulum", "gas spring", "printed piston", "upright cylinder"

_RIGS = Path("assets") / "real"


def _friction(*places: str) -> tuple[Name, ...]:
    """Return the names of dry and viscous friction in all its forms, any of which a sliding seal has."""
    forms = (
        "coulomb_friction",
        "asymmetric_friction",
        "viscous_friction",
        "stribeck_friction",
        "pressure_dependent_friction",
        "presliding",
    )
    return tuple(Name((form,), places) for form in forms)


def _zeros(*columns: str) -> tuple[Name, ...]:
    """Return offsets and scales of columns: a load cell's or a pressure's calibration is never exact."""
    return tuple(Name((name,), columns) for name in ("sensor_bias", "sensor_scale"))


_SEAT = ("piston", "slide")
_DRY = Name(("coulomb_friction", "asymmetric_friction"), _SEAT)
_BESIDE = Name(("coulomb_friction", "asymmetric_friction", "viscous_friction", "stribeck_friction"), _SEAT)
_GROWING = Name(("pressure_dependent_friction",), _SEAT)
_SEAL_ODD = (*_friction(*_SEAT), *_zeros("piston.pressure_1", "slide.external_force"))
_ZILLEN = "E. Zillen, 3D-printed pneumatic actuators (PMC10907517), CC0"
_MBARI = "MBARI WEC simulator, osrf/mbari_wec_gz, Apache-2.0"


def _renamed(recording: Recording, parts: Mapping[str, str]) -> Recording:
    def new(key: str) -> str:
        part, _, signal = key.partition(".")
        return f"{parts.get(part, part)}.{signal}"

    return replace(
        recording,
        columns={new(key): values for key, values in recording.columns.items()},
        units={new(key): unit for key, unit in recording.units.items()},
    )


def _emps(data: Path) -> RealCase:
    given, held = (emps.read_emps(data / "emps" / name) for name in ("DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"))
    known = Known(
        must=(Name(("coulomb_friction", "asymmetric_friction"), ("slide",)), Name(("viscous_friction",), ("slide",))),
        may=(*_friction("slide"), *_zeros("slide.external_force")),
        unknown=True,  # viscous friction differs between the directions, for which the contract has no name
        published={},
        source="Janot, Gautier, Brunot (2019); honest: friction of each direction; published 3.69 N, as believed 38.9",
    )
    return RealCase("emps", DRIVE, "emps", (given,), (held,), BALANCE, "predicted", known, POSITIONING)


def _pendulum(data: Path) -> RealCase:
    swings = pendulum.read_pendulum(data / "pendulum" / "SinglePendulumDataForParameterEstimation.mat")
    known = Known(
        must=(Name(("coulomb_friction", "asymmetric_friction"), ("arm",)), Name(("quadratic_drag",), ("arm",))),
        may=(Name(("viscous_friction",), ("arm",)), Name(("sensor_bias",), ("arm.position",))),
        unknown=False,
        published={"arm.position": 9.8e-3},
        source="dynamicslab MultiArm-Pendulum, MIT; published honest model: Coulomb friction and quadratic drag together",
    )
    given = tuple(swing for name, swing in swings.items() if name.startswith("identify"))
    held = tuple(swing for name, swing in swings.items() if name.startswith("validate"))
    return RealCase("pendulum", PENDULUM, "pendulum", given, held, FREE_RUN, "predicted", known)


def _gas_spring(data: Path) -> RealCase:
    whole = gas_spring.read_gas_spring(data / "gas_spring" / "2022.01.28T16.46.31.exp")
    known = Known(
        must=(Name(("wall_heat_transfer",), ("spring",)),),
        may=(
            Name(("moving_wall_temperature",), ("spring",)),
            Name(("sensor_delay",), ("spring.pressure_1", "spring.pressure_2", "piston.position")),
            *_zeros("spring.pressure_1", "spring.pressure_2"),
        ),
        unknown=True,  # the wall warms by a law of its own
        published={},
        source=f"{_MBARI}; honest: heat with one coefficient a chamber; published polytropic exponents leave 0.30 and 0.25 bar",
    )
    return RealCase("gas_spring", SPRING, "gas_spring", (first(whole, GIVEN),), (whole,), TAIL, "recorded", known)


def _seal(data: Path, seal: str, name: str, must: tuple[Name, ...]) -> RealCase:
    runs = [seals.read_friction(path) for path in sorted((data / "seals" / "friction").glob(f"{seal}_*.csv"))]
    known = Known(
        must=must,
        may=_SEAL_ODD,
        unknown=True,  # half a newton depends on the place and on time
        published={},
        source=f"{_ZILLEN}; honest: Coulomb, with pressure, viscous, scale and zero of the pressure, place",
    )
    given, held = (tuple(part(run, GIVEN) for run in runs) for part in (first, rest))
    return RealCase(name, PISTON, "seals_friction", given, held, BALANCE, "predicted", known, SLIDING)


def _decay(data: Path, file: str, name: str, must: tuple[Name, ...]) -> RealCase:
    whole = seals.read_pressure_decay(data / "seals" / "pressure_decay" / f"{file}.csv")
    known = Known(
        must=must,
        may=(Name(("wall_heat_transfer",), ("piston",)),) if must else (),
        unknown=False,
        published={},
        source=f"{_ZILLEN}; honest: a porous leak, p^2 - p_atm^2 = w/a + b w^2" if must else f"{_ZILLEN}; the control without a leak",
    )
    given = whole.span(0.0, DECAY_GIVEN)
    return RealCase(name, PISTON, "pressure_decay", (given,), (whole,), TAIL, "recorded", known, held_from=SHUT if must else 0.0)


def _unkind_seal(data: Path, seal: str, published: float) -> RealCase:
    folder = data / "unkind" / f"seal_{seal}"
    given = tuple(read(path).recording for path in sorted(folder.glob("recording*.csv")))
    held = tuple(read(path).recording for path in sorted((folder / "held_out").glob("*.csv")))
    known = Known(
        must=(_GROWING, _BESIDE),
        may=_SEAL_ODD,
        unknown=True,
        published={"slide.external_force": published},
        source=f"{_ZILLEN}; the rest of each run",
    )
    return RealCase(f"seal_{seal}", PISTON, str(folder), given, held, BALANCE, "predicted", known, SLIDING)


def _spring_moving(data: Path) -> RealCase:
    folder = data / "unkind" / "spring_moving"
    other = gas_spring.read_gas_spring(data / "gas_spring" / "2022.01.28T16.46.31.exp")
    known = Known(
        must=(
            Name(("wall_heat_transfer",), ("piston",)),
            Name(("sensor_delay",), ("piston.pressure_1", "piston.pressure_2")),
            Name(("coulomb_friction", "asymmetric_friction"), _SEAT),
        ),
        may=(
            *_friction(*_SEAT),
            Name(("moving_wall_temperature",), ("piston",)),
            Name(("sensor_delay",), ("slide.position", "slide.external_force")),
            *_zeros("piston.pressure_1", "piston.pressure_2", "slide.external_force"),
        ),
        unknown=True,
        published={"piston.pressure_1": 4.6e3, "piston.pressure_2": 3.5e3},
        source=f"{_MBARI}; another day's run, whose logger is not late; heat alone 0.20 and 0.17 bar, published polytropic 0.41 and 0.84",
    )
    return RealCase(
        "spring_moving", SPRING, str(folder), (read(folder / "recording.csv").recording,),
        (_renamed(other, {"spring": "piston", "piston": "slide"}),), FREE_RUN, "recorded", known, sensors_too=False,
    )  # fmt: skip


def _spring_vented(data: Path) -> RealCase:
    folder = data / "unkind" / "spring_vented"
    whole = read(folder / "recording.csv").recording
    known = Known(
        must=(_DRY,),
        may=(
            *_friction(*_SEAT),
            *_zeros("piston.pressure_1", "piston.pressure_2", "slide.external_force"),
        ),
        unknown=True,
        published={},
        source=f"{_MBARI}; honest: Coulomb and viscous friction and a constant",
    )
    return RealCase(
        "spring_vented", SPRING, str(folder), (first(whole, GIVEN),), (rest(whole, GIVEN),), BALANCE, "predicted", known, STROKES
    )


def _upright(data: Path) -> RealCase:
    folder = data / "unkind" / "upright"
    whole = read(folder / "recording.csv").recording
    known = Known(
        must=(),
        may=(
            *_friction(*_SEAT),
            Name(("exhaust_back_pressure", "line_restriction"), ("exhaust", "piston")),
            *_zeros("piston.pressure_1"),
        ),
        unknown=True,
        published={},
        source="jefersonjlima/wbident, MIT: nobody published more than gravity, friction and a throttled exhaust; without a command, "
        '"undetermined" is right',
    )
    return RealCase(
        "upright", LIFT, str(folder), (first(whole, GIVEN),), (rest(whole, GIVEN),), BALANCE, "predicted", known,
        Moving(cut_off=30.0, speed=1e-2),
    )  # fmt: skip


_MACHINES: dict[str, Callable[[Path], RealCase]] = {
    "emps": _emps,
    "pendulum": _pendulum,
    "gas_spring": _gas_spring,
    "kdn": lambda data: _seal(data, "KDN", "kdn", (_DRY,)),
    "o_ring": lambda data: _seal(data, "O-ring", "o_ring", (_GROWING, _BESIDE)),
    "ultimaker": lambda data: _decay(data, "Ultimaker_015", "ultimaker", (Name(("external_leakage",), ("piston",)),)),
    "aluminium": lambda data: _decay(data, "Aluminium", "aluminium", ()),
    "seal_napn": lambda data: _unkind_seal(data, "napn", 0.94),
    "seal_pk": lambda data: _unkind_seal(data, "pk", 0.63),
    "spring_moving": _spring_moving,
    "spring_vented": _spring_vented,
    "upright": _upright,
}


def _cut(by: Callable[[RealCase], RealCase], name: str) -> Callable[[Path], RealCase]:
    return lambda data: by(_MACHINES[name](data))


_VARIANTS: dict[str, Callable[[Path], RealCase]] = {
    "emps_half": _cut(halved, "emps"),
    "pendulum_two": lambda data: with_given(_pendulum(data), "pendulum_two", _pendulum(data).recordings[:2]),
    "gas_spring_half": _cut(halved, "gas_spring"),
    "o_ring_ends": _cut(ends, "o_ring"),
    **{f"{seal}_20hz": _cut(thinned, seal) for seal in ("kdn", "o_ring", "seal_napn", "seal_pk")},
}

NAMES = (*_MACHINES, *_VARIANTS)
MACHINES, VARIANTS = tuple(_MACHINES), tuple(_VARIANTS)


def real_case(name: str, data: Path) -> RealCase:
    """Return a case by name.

    Args:
        name: Of `NAMES`.
        data: The folder with emps/, pendulum/, gas_spring/, seals/ and unkind/.

    Raises:
        TrialError: there is no such case, or its recordings are not there.
    """
    makers = _MACHINES | _VARIANTS
    if name not in makers:
        raise TrialError(f'no real machine "{name}"; there is: {", ".join(NAMES)}')
    try:
        case = makers[name](data)
    except (OSError, IndexError, RecordingError):
        raise TrialError(f'the recordings of "{name}" are not in {data}; give the folder that holds emps/, seals/, unkind/, ...') from None
    if not case.recordings:
        raise TrialError(f'the recordings of "{name}" are not in {data}')
    return case


def rig_of(case: RealCase, repository: Path) -> Path:
    """Return the folder of a case's rig.toml and MJCF."""
    own = Path(case.rig)
    return own if own.is_absolute() else repository / _RIGS / case.rig
