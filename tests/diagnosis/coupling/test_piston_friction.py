"""Friction of a piston behind a soft transmission is handed to the gas; behind a stiff one it is nobody's business there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import motion_runs, waves

from exo_sim.diagnosis.coupling.piston_friction import friction_behind_soft_transmissions, is_soft, softens
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult

FORCE = FreeParameter("coulomb_friction", "piston", "force", "N", Target.CYLINDER, 1.0, 0.0, 1e3)
MASS = FreeParameter("payload_mass", "slide", "payload_mass", "1", Target.SENSOR, 0.02, 0.2, 5.0)
STIFFNESS = FreeParameter("transmission_compliance", "piston", "stiffness", "N/m", Target.CYLINDER, 1e5, 0.0, 1e9)
FRICTION = Candidate("coulomb_friction", "piston", "force", (FORCE,), ((1.0,),))
SOFT = Candidate("transmission_compliance", "piston", "stiffness", (STIFFNESS,), ((1e5,),))


def result(values: dict[FreeParameter, float], *named: Candidate) -> SubsystemResult[waves.Waves]:
    model = waves.Waves()
    model.nominal = motion_runs.plant()
    final = FittedModel(named, Fit(tuple(values), values, np.zeros(4), np.zeros((4, len(values)))))
    return SubsystemResult("piston", model, ModelFits(model, ()), SearchResult(final, final), final, named)


@pytest.mark.parametrize(("effect", "soft"), [("transmission_compliance", True), ("backlash", True), ("coulomb_friction", False),
                                              ("no_such_effect", False)])  # fmt: skip
def test_a_transmission_is_soft_by_its_family(effect: str, soft: bool) -> None:
    assert is_soft(effect) is soft


def test_a_model_softens_where_a_transmission_is_in_it() -> None:
    assert softens(result({STIFFNESS: 1e5}, SOFT).final) and not softens(result({FORCE: 5.0}, FRICTION).final)


def test_friction_behind_a_soft_transmission_goes_to_the_gas_without_what_is_no_number_of_the_cylinder() -> None:
    soft, motion = result({STIFFNESS: 1e5}, SOFT), result({FORCE: 5.0, MASS: 1.1}, FRICTION)
    assert friction_behind_soft_transmissions([soft], [motion]) == {"piston": [(FORCE, 5.0)]}


def test_nothing_goes_where_the_transmission_is_stiff_nothing_is_named_or_something_stays_unknown() -> None:
    soft, motion = result({STIFFNESS: 1e5}, SOFT), result({FORCE: 5.0}, FRICTION)
    sensor = replace(FRICTION, kind=Kind.SENSOR)
    for gas, forces in ((result({}), motion), (soft, result({FORCE: 5.0})), (soft, replace(motion, has_unknown=True)),
                        (soft, replace(motion, named=(sensor,)))):  # fmt: skip
        assert friction_behind_soft_transmissions([gas], [forces]) == {}
