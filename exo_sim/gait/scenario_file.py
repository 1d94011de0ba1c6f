"""Scenario files: what somebody does in the machine, in a TOML file from anywhere.

One of four things makes the motion::

    summary = "my walk"              # optional, the line that lists show
    strides = 10                     # optional, how many strides or repetitions
    wearer  = "torques"              # optional: the wearer is a body that yields, moved by torques; else his motion is "prescribed"

    [gait]                           # walking with the mean stride of a recorded trial
    file   = "walk.csv"              # .mot, .sto, .c3d, .csv, .parquet, .rrd; beside this file
    ground = "forces.mot"            # optional: ground forces of the same trial
    from   = "2 s"                   # optional: the part of the trial that counts
    to     = "8 s"
    whole  = true                    # optional: walk every stride as it is, not the mean of them
    knee_l = "L knee flex"           # optional: which column is which angle (hip, knee, ankle _l and _r; tilt, pelvis_x, pelvis_z)
    [gait.columns]                   # optional, for tables: foreign name = contract name with unit, as in a column map
    "L knee flex" = { column = "knee_l.position [deg]", scale = -1.0 }

    like = "squat"                   # or: another scenario, with another length or an [added] load

    [standing]                       # or: a motion with both feet flat on the ground, values evenly spaced over the cycle
    period = "3 s"
    knee   = ["-10 deg", "-90 deg"]  # flexion is negative
    ankle  = ["7 deg", "25 deg"]
    lean   = ["8 deg", "30 deg"]     # of the torso, forward

    [stairs]                         # or: walking stairs, one foot a tread
    rise   = "170 mm"                # of each tread; negative goes down
    tread  = "290 mm"
    period = "1.4 s"                 # of two treads

    speed = "0.9 m/s"                # optional with a walk's mean stride: strides as long and as quick as people take them at that speed
    grade = 0.08                     # optional with it: up a slope that rises so much a metre; negative goes down
    [hung]                           # optional with any of them: mass on bodies of the machine beside their own, for a load that is uneven
    thigh_l = "3 kg"

    [variation]                      # optional with any of them: strides that are not the mean one
    stride_time = 0.02               # standard deviation of the stride's time over its mean
    asymmetry   = 0.0                # time of the right foot's step more than the left's, over the stride's
    lean        = "3 deg"            # of the trunk, forward, more than the motion's
    seed        = 0

    [added]                          # optional with any of them: mass put on the back on the way
    mass = "20 kg"
    at   = 5.0                       # in strides or repetitions
    over = "0.3 s"
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exo_sim import units
from exo_sim.errors import ExoSimError, ScenarioError, UnitError, nearest
from exo_sim.gait import own_gait
from exo_sim.gait.included_scenarios import included, names
from exo_sim.gait.motion import SAMPLES, Motion
from exo_sim.gait.scenario_record import WEARERS, AddedLoad, Scenario
from exo_sim.gait.stairs import DOWN, UP, walking_stairs
from exo_sim.gait.standing import on_both_feet
from exo_sim.gait.variation import Variation
from exo_sim.gait.walking_trial import JOINTS, PELVIS
from exo_sim.inputs import refusing, text_of, toml
from exo_sim.machine.ground import Ground
from exo_sim.machine.person import Person
from exo_sim.recording.column_map import ColumnMap, column_of
from exo_sim.recording.columns import Column

_MAKERS = ("gait", "like", "standing", "stairs")
_ANGLES = (*JOINTS, *PELVIS)
#: Most that is hung on a body of the machine [kg].
_MOST_HUNG = 20.0


def read(path: str | Path) -> Scenario:
    """Read a scenario file.

    Raises:
        ScenarioError: one line that names the file, the key, the value and what to do.
    """
    path = Path(path)
    with refusing(lambda says: ScenarioError(f"{path}: {says}"), "there is no such scenario file"):
        values = toml(text_of(path))
    _only(path, "", values, ("summary", "strides", "wearer", "speed", "grade", "hung", "added", "variation", *_MAKERS))
    made_by = [key for key in _MAKERS if key in values]
    if len(made_by) != 1:
        raise ScenarioError(f"{path}: one of [gait], [standing], [stairs] and like makes a scenario; there {_are(made_by)}")
    made = {"gait": _gait, "like": _like, "standing": _standing, "stairs": _stairs}[made_by[0]](path, values[made_by[0]])
    if "summary" in values:
        made = replace(made, summary=_text(path, "summary", values["summary"]))
    if "strides" in values:
        strides = values["strides"]
        if isinstance(strides, bool) or not isinstance(strides, int) or not 1 <= strides <= 10000:
            raise ScenarioError(f"{path}: strides = {strides!r}: write a whole number from 1 to 10000")
        made = replace(made, cycles=strides)
    if "wearer" in values:
        wearer = _text(path, "wearer", values["wearer"])
        if wearer not in WEARERS:
            raise ScenarioError(f'{path}: wearer = "{wearer}"{nearest(wearer, WEARERS)}')
        made = replace(made, wearer=wearer)
    if "speed" in values:
        made = replace(made, pace=_quantity(path, "speed", values["speed"], "m/s"))
    if "grade" in values:
        made = replace(made, grade=_grade(path, values["grade"]))
    if "hung" in values:
        made = replace(made, hung=_hung(path, values["hung"]))
    if "variation" in values:
        made = replace(made, variation=_variation(path, values["variation"]))
    return replace(made, added=_added(path, values["added"])) if "added" in values else made


def _are(keys: list[str]) -> str:
    return f"are {' and '.join(keys)}" if keys else "is none of them"


def _gait(path: Path, given: Any) -> Scenario:
    table = _table(path, "gait", given)
    _only(path, "gait", table, ("file", "ground", "from", "to", "whole", "columns", *_ANGLES))
    if "file" not in table:
        raise ScenarioError(f'{path}: gait.file is missing: name the file of joint angles, like file = "walk.mot"')
    named = {name: _text(path, f"gait.{name}", table[name]) for name in _ANGLES if name in table}
    columns, more = _columns(path, table.get("columns", {}))
    file = own_gait.GaitFile(
        path.parent / _text(path, "gait.file", table["file"]),
        path.parent / _text(path, "gait.ground", table["ground"]) if "ground" in table else None,
        {**more, **named},
        columns,
        _quantity(path, "gait.from", table["from"], "s") if "from" in table else -np.inf,
        _quantity(path, "gait.to", table["to"], "s") if "to" in table else np.inf,
        _yes(path, "gait.whole", table.get("whole", False)),
    )
    try:
        return own_gait.scenario(file)
    except ExoSimError as error:
        raise type(error)(f"{path}: [gait]: {error}") from None


def _columns(path: Path, given: Any) -> tuple[ColumnMap | None, dict[str, str]]:
    """Return a map of foreign columns to the contract's, and angles whose label alone is given (`"L knee" = "knee_l"`)."""
    table = _table(path, "gait.columns", given)
    found: dict[str, Column] = {}
    named: dict[str, str] = {}
    for foreign, ours in table.items():
        if ours in _ANGLES:
            named[ours] = foreign
            continue
        try:
            found[foreign] = column_of(f'{path}: gait.columns."{foreign}"', foreign, ours)
        except ExoSimError as error:
            raise ScenarioError(str(error)) from None
    return (ColumnMap(path, found) if found else None), named


def _like(path: Path, given: Any) -> Scenario:
    name = _text(path, "like", given)
    if name not in names():
        raise ScenarioError(f'{path}: like = "{name}": no such scenario{nearest(name, names())}')
    return included(name)


def _standing(path: Path, given: Any) -> Scenario:
    table = _table(path, "standing", given)
    _only(path, "standing", table, ("period", "knee", "ankle", "lean"))
    for key in ("period", "knee", "ankle", "lean"):
        if key not in table:
            raise ScenarioError(f"{path}: standing.{key} is missing; a motion on both feet has period, knee, ankle and lean")
    period = _quantity(path, "standing.period", table["period"], "s")
    if not 0.2 <= period <= 600.0:
        raise ScenarioError(f"{path}: standing.period = {period:g} s: write 0.2 s to 600 s")
    curves = {key: _curve(path, f"standing.{key}", table[key]) for key in ("knee", "ankle", "lean")}
    if curves["knee"].max() > np.radians(5.0):
        raise ScenarioError(f"{path}: standing.knee reaches {np.degrees(curves['knee'].max()):.0f} deg; flexion is negative")

    return Scenario(f"standing motion of {path.name}", partial(_on_both_feet, period, curves), cycle="repetition", cycles=5)


def _stairs(path: Path, given: Any) -> Scenario:
    table = _table(path, "stairs", given)
    _only(path, "stairs", table, ("rise", "tread", "period"))
    for key in ("rise", "tread"):
        if key not in table:
            raise ScenarioError(f'{path}: stairs.{key} is missing; stairs have rise and tread, like rise = "170 mm", tread = "290 mm"')
    rise, tread = (_quantity(path, f"stairs.{key}", table[key], "m") for key in ("rise", "tread"))
    period = _quantity(path, "stairs.period", table["period"], "s") if "period" in table else UP.period if rise > 0.0 else DOWN.period
    if rise == 0.0 or not 0.8 <= period <= 5.0:
        raise ScenarioError(f"{path}: stairs: rise {rise:g} m in a cycle of {period:g} s; write a rise other than nil, and 0.8 s to 5 s")
    try:
        Ground(rise / tread if tread else 1e9, tread or 1e-9)
    except ScenarioError as error:
        raise ScenarioError(f"{path}: {error}") from None
    stairs = replace(UP if rise > 0.0 else DOWN, rise=rise, tread=tread, period=period)
    return Scenario(f"stairs of {path.name}, drawn", partial(walking_stairs, stairs))


def _grade(path: Path, given: Any) -> float:
    if isinstance(given, bool) or not isinstance(given, int | float) or not np.isfinite(given):
        raise ScenarioError(f"{path}: grade = {given!r}: write rise over run, like 0.08")
    try:
        return Ground(float(given)).grade
    except ScenarioError as error:
        raise ScenarioError(f"{path}: {error}") from None


def _hung(path: Path, given: Any) -> dict[str, float]:
    table = {name: _quantity(path, f"hung.{name}", mass, "kg") for name, mass in _table(path, "hung", given).items()}
    for name, mass in table.items():
        if not 0.0 <= mass <= _MOST_HUNG:
            raise ScenarioError(f"{path}: hung.{name} = {mass:g} kg: write 0 kg to {_MOST_HUNG:g} kg")
    return table


def _on_both_feet(period: float, curves: Mapping[str, NDArray[np.float64]], person: Person) -> Motion:
    return on_both_feet(person, period, curves["knee"], curves["ankle"], curves["lean"])


def _curve(path: Path, key: str, given: Any) -> NDArray[np.float64]:
    """Return a periodic curve through evenly spaced values, smooth, without overshoot between two of them, shape (SAMPLES,)."""
    values = np.array([_quantity(path, key, value, "rad") for value in (given if isinstance(given, list) else [given])])
    if not 1 <= len(values) <= 100:
        raise ScenarioError(f"{path}: {key} has {len(values)} values; write 1 to 100")
    if np.abs(values).max() > np.radians(150.0):
        raise ScenarioError(f"{path}: {key} reaches {np.degrees(np.abs(values).max()):.0f} deg, which no joint does")
    at = np.arange(SAMPLES) / SAMPLES * len(values)
    before = at.astype(int) % len(values)
    share = at % 1.0
    rise = share**4 * (35 - 84 * share + 70 * share**2 - 20 * share**3)
    return np.asarray(values[before] + (values[(before + 1) % len(values)] - values[before]) * rise)


def _variation(path: Path, given: Any) -> Variation:
    table = _table(path, "variation", given)
    _only(path, "variation", table, ("stride_time", "asymmetry", "lean", "seed"))
    for key in ("stride_time", "asymmetry"):
        value = table.get(key, 0.0)
        if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
            raise ScenarioError(f"{path}: variation.{key} = {value!r}: write a share of the stride's time, like 0.02")
    seed = table.get("seed", 0)
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise ScenarioError(f"{path}: variation.seed = {seed!r}: write a whole number, 0 or more")
    lean = _quantity(path, "variation.lean", table["lean"], "rad") if "lean" in table else 0.0
    try:
        return Variation(float(table.get("stride_time", 0.0)), float(table.get("asymmetry", 0.0)), lean, seed)
    except ScenarioError as error:
        raise ScenarioError(f"{path}: {error}") from None


def _added(path: Path, given: Any) -> AddedLoad:
    table = _table(path, "added", given)
    _only(path, "added", table, ("mass", "at", "over"))
    if "mass" not in table:
        raise ScenarioError(f'{path}: added.mass is missing, like mass = "20 kg"')
    at = table.get("at", 5.0)
    if isinstance(at, bool) or not isinstance(at, int | float) or not 0.0 <= at <= 10000.0:
        raise ScenarioError(f"{path}: added.at = {at!r}: write after how many strides or repetitions, like 5.0")
    mass, over = _quantity(path, "added.mass", table["mass"], "kg"), _quantity(path, "added.over", table.get("over", "0.3 s"), "s")
    if not 0.0 < mass <= 100.0 or not 0.01 <= over <= 60.0:
        raise ScenarioError(f"{path}: added: mass {mass:g} kg over {over:g} s; write up to 100 kg over 0.01 s to 60 s")
    return AddedLoad(mass, float(at), over)


def _table(path: Path, key: str, given: Any) -> Mapping[str, Any]:
    if not isinstance(given, Mapping):
        raise ScenarioError(f"{path}: {key} = {given!r} must be a table: write [{key}] above its keys")
    return given


def _text(path: Path, key: str, given: Any) -> str:
    if not isinstance(given, str) or not given:
        raise ScenarioError(f"{path}: {key} = {given!r} must be text in quotes")
    return given


def _yes(path: Path, key: str, given: Any) -> bool:
    if not isinstance(given, bool):
        raise ScenarioError(f"{path}: {key} = {given!r}: write true or false")
    return given


def _quantity(path: Path, key: str, given: Any, unit: str) -> float:
    try:
        return units.parse(given, unit)
    except UnitError as error:
        raise ScenarioError(f"{path}: {key}: {error}") from None


def _only(path: Path, key: str, table: Mapping[str, Any], known: tuple[str, ...]) -> None:
    for each in table:
        if each not in known:
            raise ScenarioError(f"{path}: {key}{'.' if key else ''}{each} is not a key of a scenario{nearest(each, known)}")
