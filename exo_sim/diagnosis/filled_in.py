"""Balances of forces that lack one pressure: it is filled in from the judged gas of its cylinder, with what that leaves open.

The chamber that nobody measured follows from the command, the motion and the supply by the same equations that the other chamber has just
been judged with. What the other chamber cannot say of it (its first pressure, its own dead volume, and a leak where none is known of
the cylinder) stays free in the balance.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from copy import copy
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from exo_sim.diagnosis.cases import Case, balance_asked
from exo_sim.diagnosis.gas_cut import Windows
from exo_sim.diagnosis.gas_problem import GasProblem
from exo_sim.diagnosis.intervals import normalised, spreads
from exo_sim.diagnosis.judging import Judged
from exo_sim.diagnosis.library import healthy_leaks
from exo_sim.diagnosis.motion_cut import MotionRun, as_smooth, motion_runs, smooth_on_clock
from exo_sim.diagnosis.observed import CylinderRun, breaks_of
from exo_sim.diagnosis.quantity import Setting
from exo_sim.diagnosis.replay_inputs import led_from_outside
from exo_sim.diagnosis.split import Split
from exo_sim.diagnosis.verdict import setting_of
from exo_sim.physics.effects.declaration import declared
from exo_sim.recording.table import Recording

Array = NDArray[np.float64]

#: To what the pressure at the very start is sought that suits the balance best, and how unsure that stays, one standard deviation [Pa].
START_TOLERANCE, START_SPREAD = 500.0, 1e4
#: The first seconds, whose balance says with which pressure an unmeasured chamber began [s]; and what of a recording that is kept back
#: whole may be looked at for it.
SOON, BEGINNING = 0.05, 1.0
#: What changes the pressure by less than this is no uncertainty of it [Pa].
LEAST = 20.0


def begun_by_forces(case: Case, run: CylinderRun) -> CylinderRun:
    """Return a run that knows from the balance of forces with which pressure a chamber that nobody measured began."""
    table, side = case.table(run.recording), _lacking(case, run)
    if side is None:
        return run
    column, atmosphere = f"{run.cylinder}.pressure_{side + 1}", case.rig.environment.pressure
    _, balance = _balanced(case, table, run.cylinder, column, np.full(len(table.time), atmosphere))
    if balance is None or column not in balance.levers:
        return run
    soon = balance.time < balance.time[0] + SOON
    pressure = atmosphere + float(np.median(_lacks(balance)[soon] / balance.levers[column][soon]))
    begun = [math.nan, math.nan]
    begun[side] = float(np.clip(pressure, *_possible(case, run)))
    return replace(run, begun=(begun[0], begun[1]))


def filled_in(case: Case, gas: Sequence[Judged], parts: Split) -> None:
    """Add to a case the balances that lack one pressure of a cylinder whose gas was judged; their open questions are taken off.

    Where another recording holds all that the balance of a joint needs, that one is judged alone.
    """
    for one in gas:
        if one.empty or one.nameless:
            continue
        joint = case.joint_of(one.where)
        whole = GasProblem(case.cylinders[one.where], setting_of(one, one.trial), parts, held_out=True)
        for index, feed in enumerate(whole.feeds):
            side = _lacking(case, feed.run)
            if side is None or any(not run.filled_in for run in case.joints.get(joint, ())):
                continue
            run = _Unmeasured(case, one, whole, index, side).balance()
            if run is None:
                continue
            case.joints[joint] = [*case.joints.get(joint, ()), run]
            case.open[:] = [q for q in case.open if q.question != balance_asked(joint, run.recording)]
            case.remarks.append(
                f"{run.recording}: {one.where}.pressure_{side + 1} was not recorded; the balance of forces takes what the gas, "
                "as judged by the other chamber, predicts"
            )


class _Unmeasured:
    """The chamber of one run that nobody measured, as the judged gas of its cylinder predicts it."""

    def __init__(self, case: Case, judged: Judged, whole: GasProblem, index: int, side: int):
        self.case, self.judged, self.whole, self.index, self.side = case, judged, whole, index, side
        self.feed = whole.feeds[index]
        self.table = case.table(self.feed.run.recording)
        self.column = f"{judged.where}.pressure_{side + 1}"

    def balance(self) -> MotionRun | None:
        """Return the balance of the cylinder's joint; None where even then nothing can be said."""
        setting, cylinder = self.whole.setting, self.judged.where
        begun = self._begun()
        if begun is None:
            return None
        pressure = self._pressure(setting, begun)
        longer, run = _balanced(self.case, self.table, cylinder, self.column, pressure)
        if run is None or run.cylinder is None or run.joint in led_from_outside(longer, self.case.rig, self.case.model, self.case.links):
            return None
        lever = run.levers.pop(self.column)

        def felt(changed: Array) -> Array:
            return lever * smooth_on_clock(run, self.table.time, changed - pressure)

        unsure = {f"start of {run.recording}": felt(self._pressure(setting, begun + START_SPREAD))}
        unsure |= {name: felt(self._pressure(moved, begun)) for name, moved in _moved(self.judged)}
        least = LEAST * float(np.median(np.abs(lever)))
        leaks = {name: felt(self._pressure(leaky, begun)) / size for name, size, leaky in self._leaking(setting)}
        if not all(np.isfinite(change).all() for change in (pressure, *unsure.values(), *leaks.values())):
            return None
        missed = as_smooth(self.table.time, self.whole.errors(setting)[self.index][:, 1 - self.side])
        other = normalised(missed[self._shown(self.table.time)])
        return replace(
            run,
            filled_in=True,
            unsure={name: change for name, change in unsure.items() if float(np.max(np.abs(change))) > least},
            leaks=leaks,
            noise=float(np.hypot(run.noise, other * np.sqrt(np.mean(lever**2)))),
        )

    def _pressure(self, setting: Setting, begun: float) -> Array:
        """Return the pressure of a machine that began with so much, shape (n,) [Pa]."""
        windows = self.feed.windows
        starts = windows.pressure.copy()
        starts[0, self.side] = begun
        alone = copy(self.whole)
        alone.feeds = [replace(self.feed, windows=Windows(windows.starts, windows.stops, starts))]
        return alone.predict(setting, 0).inside[:, self.side]

    def _begun(self) -> float | None:
        """Return the first pressure that leaves least in the balance of all that follows [Pa]."""
        setting = self.whole.setting
        low, high = _possible(self.case, self.feed.run)
        guess = self._pressure(setting, low)
        _, run = _balanced(self.case, self.table, self.judged.where, self.column, guess)
        if run is None:
            return None
        lever, lacks, shown = run.levers[self.column], _lacks(run), self._shown(run.time)

        def left(begun: float) -> float:
            changed = smooth_on_clock(run, self.table.time, self._pressure(setting, begun) - guess)
            rest = (lacks - lever * changed)[shown]
            return float(np.mean(np.abs(rest - np.median(rest))))

        return float(minimize_scalar(left, bounds=(low, high), method="bounded", options={"xatol": START_TOLERANCE}).x)

    def _shown(self, time: Array) -> NDArray[np.bool_]:
        """Return at which times numbers may be fitted; of a recording that is kept back whole at its beginning, shape (n,)."""
        fitted = self.whole.split.training(self.table.name, time)
        return fitted if fitted.any() else time < time[0] + BEGINNING

    def _leaking(self, setting: Setting) -> Iterator[tuple[str, float, Setting]]:
        """Yield each parameter of a leak of this chamber alone, a size of it, and the machine that has it; none where a leak is known."""
        if setting.is_on(declared()["external_leakage"]):
            return
        for name, size in healthy_leaks(setting).items():
            if name.endswith(str(self.side + 1)):
                leaky = setting.copy()
                leaky.cylinder["external_leakage"][name] = size
                yield name, size, leaky


def _lacking(case: Case, run: CylinderRun) -> int | None:
    """Return which of two chambers was not measured, 0 or 1; None where that is not the question, or a load cell answers it.

    Nor is it one across a jump of the clock: nobody knows what the chamber did meanwhile.
    """
    lacking = [side for side in range(2) if run.pressure[side] is None]
    whole = len(run.time) == len(case.table(run.recording).time) and len(breaks_of(run.time)) == 1
    if case.rig.cylinders[run.cylinder].single_acting or run.force is not None or not whole or len(lacking) != 1:
        return None
    return lacking[0]


def _possible(case: Case, run: CylinderRun) -> tuple[float, float]:
    """Return between which pressures a chamber may begin [Pa]."""
    atmosphere = case.rig.environment.pressure
    highest = [case.rig.supply.pressure if run.supply is None else float(np.max(run.supply)), 2.0 * atmosphere]
    highest += [float(np.nanmax(pressure)) for pressure in run.pressure if pressure is not None]
    return 0.5 * atmosphere, max(highest)


def _balanced(case: Case, table: Recording, cylinder: str, column: str, pressure: Array) -> tuple[Recording, MotionRun | None]:
    """Return a recording with one pressure more, and by it the balance of the joint that a cylinder drives."""
    joint = case.joint_of(cylinder)
    longer = replace(table, columns={**table.columns, column: pressure}, units={**table.units, column: "Pa"})
    return longer, next((run for run in motion_runs(longer, case.rig, case.model, case.links)[0] if run.joint == joint), None)


def _lacks(run: MotionRun) -> Array:
    """Return what the forces of a balance lack before anything resists, shape (n,)."""
    return run.inertial - run.passive - run.drive - run.external


def _moved(one: Judged) -> Iterator[tuple[str, Setting]]:
    """Yield every number that the judged gas hangs on, by name, with the machine that has it off by one standard deviation."""
    assert isinstance(one.problem, GasProblem)
    spread = spreads(one.problem, one.trial.fit, one.sets.correlation_time(one.trial.fit.residual))
    for quantity, value in one.trial.fit.values.items():
        step = spread.get(quantity, 0.0)
        moved = value + step if value + step <= quantity.high else max(value - step, quantity.low)
        if quantity.target != "sensor" and moved != value:
            yield " ".join(quantity.key), one.problem.apply({**one.trial.fit.values, quantity: moved}, one.trial.fixed)
