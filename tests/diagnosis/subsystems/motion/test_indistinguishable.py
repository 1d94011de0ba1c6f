"""What a balance of forces cannot tell apart, and which error of a sensor a number of it stands for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import motion_runs
from diagnosis.motion_runs import POSITION, TIME

from exo_sim.diagnosis.data.motion_run import MotionRun, Passive
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.subsystems.motion import indistinguishable
from exo_sim.diagnosis.subsystems.motion.indistinguishable import (
    force_of_zeros,
    friction_beside_constant_force,
    scale_instead_of_mass,
    sensor_error_of,
)
from exo_sim.diagnosis.subsystems.motion.model import MotionModel

OFFSET = FreeParameter("offset", "slide", "offset", "N", Target.SENSOR, 1.0, -9.0, 9.0, (0.0, 1.0))
RUN = motion_runs.balance(np.zeros(TIME.size), 0.1)


def test_a_force_sensors_bias_beside_coulomb_friction_may_be_asymmetric_friction() -> None:
    def twins(size: float, *names: str) -> set[str]:
        found = [Finding(name, "slide.external_force", Kind.SENSOR, "", {"p": Estimate(1.0, "N", 0.0, 2.0)}, 9.0, 0.0) for name in names]
        closed = Fit((OFFSET,), {OFFSET: size}, np.zeros(1), np.zeros((1, 1)))
        return {name for name, _ in friction_beside_constant_force(found, closed, [RUN])}

    assert twins(0.0, "coulomb_friction") == set()
    assert twins(0.0, "coulomb_friction", "sensor_bias") == {"sensor_bias"}
    assert twins(6.0, "coulomb_friction", "sensor_bias") == {"sensor_bias", "coulomb_friction"}
    assert twins(6.0, "sensor_bias") == set()


@pytest.mark.parametrize(
    ("forward", "backward", "twins"), [(13.0, 9.0, True), (23.0, 12.0, False), (13.0, 1.0, True)],
    ids=["4 N apart", "11 N apart", "more uneven than any seal"],
)
def test_friction_of_two_directions_may_be_that_of_one_beside_a_constant_force(forward: float, backward: float, twins: bool) -> None:
    """1 % of 6 bar on 8 cm^2 are 4.8 N, and directions that differ by twice that look the same; on a sloping bench so does more."""
    levers, signals = {"piston.pressure_1": np.full(TIME.size, -8e-4)}, {"piston.pressure_1": np.full(TIME.size, 6e5)}
    drive = replace(RUN.drive, levers=levers, signals=signals)
    assert force_of_zeros(drive) == pytest.approx(4.8)
    sizes = {name: Estimate(value, "N", 0.0, 20.0) for name, value in (("forward", forward), ("backward", backward))}
    asymmetric = Finding("asymmetric_friction", "piston", Kind.MISSING_PHYSICS, "", sizes, 200.0, 0.0)  # which are against no friction
    closed = Fit((OFFSET,), {OFFSET: 0.0}, np.zeros(1), np.zeros((1, 1)))
    expected = {("asymmetric_friction", "piston"): ("coulomb_friction",)} if twins else {}
    assert friction_beside_constant_force([asymmetric], closed, [replace(RUN, drive=drive)]) == expected
    unseen = friction_beside_constant_force([asymmetric], closed, [replace(RUN, drive=replace(drive, signals={}))])
    assert unseen == (expected if backward < 0.5 * forward else {})


def _pushed(pressure: float) -> MotionRun:
    """Return a balance of one chamber of 8 cm^2 whose pressure this is [Pa above the atmosphere]."""
    levers, signals = {"piston.pressure_1": np.full(TIME.size, -8e-4)}, {"piston.pressure_1": np.full(TIME.size, pressure)}
    return replace(RUN, drive=replace(RUN.drive, levers=levers, signals=signals))


def test_the_order_of_recordings_does_not_decide_what_looks_the_same() -> None:
    """4 N apart: 1 % of 6 bar make them, 1 % of 2 bar do not."""
    sizes = {name: Estimate(value, "N", 0.0, 20.0) for name, value in (("forward", 13.0), ("backward", 9.0))}
    asymmetric = Finding("asymmetric_friction", "piston", Kind.MISSING_PHYSICS, "", sizes, 9.0, 0.0)
    closed, runs = Fit((OFFSET,), {OFFSET: 0.0}, np.zeros(1), np.zeros((1, 1))), [_pushed(2e5), _pushed(6e5)]
    both = [MotionModel(own, motion_runs.plant(), Split({})).indistinguishable([asymmetric], closed) for own in (runs, runs[::-1])]
    assert both == [{("asymmetric_friction", "piston"): ("coulomb_friction",)}] * 2
    assert MotionModel(runs[:1], motion_runs.plant(), Split({})).indistinguishable([asymmetric], closed) == {}


def test_an_effect_that_says_of_which_friction_it_is_the_richer_form_in_no_numbers_has_no_twin(monkeypatch: pytest.MonkeyPatch) -> None:
    own = replace(indistinguishable.declared()["asymmetric_friction"], absorbs=())
    monkeypatch.setattr(indistinguishable, "declared", lambda: {own.name: own})
    found = Finding(own.name, "piston", Kind.MISSING_PHYSICS, "", {"forward": Estimate(13.0, "N", 0.0, 20.0)}, 9.0, 0.0)
    closed = Fit((OFFSET,), {OFFSET: 0.0}, np.zeros(1), np.zeros((1, 1)))
    assert friction_beside_constant_force([found], closed, [_pushed(6e5)]) == {}


def test_a_mass_that_one_measured_force_moves_is_known_as_well_as_the_scale_of_that_force() -> None:
    single = replace(RUN, drive=replace(RUN.drive, levers={"slide.external_force": np.ones(TIME.size)}))
    sprung = replace(single, passive=Passive(0.1 * POSITION))
    mass = FreeParameter("payload_mass", "slide", "payload_mass", "1", Target.SENSOR, 0.02, 0.2, 5.0, (1.0, 0.05), neutral=1.0)
    for runs, twins in (([single], ("sensor_scale",)), ([single, RUN], ()), ([sprung], ())):
        assert scale_instead_of_mass(runs, mass) == twins
        assert scale_instead_of_mass(runs, replace(mass, effect="joint_inertia")) == ()


@pytest.mark.parametrize(("cell", "column", "bias"), [(True, "slide.external_force", -4.0), (False, "piston.pressure_1", -5000.0)])
def test_a_constant_force_is_the_bias_of_what_measures_force_else_of_a_pressure(cell: bool, column: str, bias: float) -> None:
    levers = {"piston.pressure_1": np.full(TIME.size, 8e-4)} | ({"slide.external_force": np.ones(TIME.size)} if cell else {})
    drive = replace(RUN.drive, levers=levers)
    assert sensor_error_of(drive, OFFSET, 4.0) == (column, "sensor_bias", "value", pytest.approx(bias))
    gain = replace(OFFSET, effect="sensor_gain", where="piston.pressure_1")
    written = (column, "sensor_scale", "factor", 0.8 if cell else 1.25)
    assert sensor_error_of(drive, gain, 1.25) == written
    assert sensor_error_of(drive, replace(OFFSET, effect="zero"), 4.0) is None
    assert sensor_error_of(RUN.drive, OFFSET, 4.0) is None
