"""Corrections stand where the rig file has the number, in its own measure: factors become areas, volumes and masses."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import benches
import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.outcome.rig_corrections import BEYOND_SHEET_NOTE, WITHIN_SHEET_NOTE, corrections
from exo_sim.diagnosis.outcome.small_findings import small_findings
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.nuisance_calibration import Deviation
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load as load_model


def factor(effect: str, where: str, name: str, target: Target = Target.FACTOR) -> FreeParameter:
    return FreeParameter(effect, where, name, "1", target, 0.1, 0.05, 10.0, (1.0, 0.1), neutral=1.0)


AREA, DEAD = factor("flow_capacity", "piston", "valve_area"), factor("dead_volume", "piston", "dead_volume_2")
MASS = factor("payload_mass", "slide", "payload_mass", Target.SENSOR)
DAMPING = FreeParameter("joint_damping", "slide", "damping", "1", Target.SENSOR, 0.1, 0.0, 1.0, (1.0, 0.3), neutral=1.0)
FRICTION = FreeParameter("coulomb_friction", "piston", "force", "N", Target.CYLINDER, 1.0, 0.0, 1e3, (10.0, 2.0))


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> MachineData:
    rig = benches.bench(tmp_path_factory.mktemp("corrections"), '[effects.coulomb_friction.piston]\nforce = "10 N"\n')
    model = load_model(rig)
    return MachineData(rig, model, linkages(rig, model), (), (), {}, {})


def result(values: dict[FreeParameter, float]) -> SubsystemResult[waves.Waves]:
    model = waves.Waves()
    final = FittedModel((), Fit(tuple(values), values, np.zeros(4), np.zeros((4, len(values)))))
    return SubsystemResult("piston", model, ModelFits(model, ()), SearchResult(final, final), final)


@pytest.mark.parametrize(
    ("parameter", "key", "believed", "unit"),
    [
        (AREA, ("cylinders", "piston", "valve", "area"), 2e-6, "m^2"),
        (DEAD, ("cylinders", "piston", "dead_volume_2"), 15e-6, "m^3"),
        (MASS, ("bodies", "load", "mass"), 8.0, "kg"),
        (FRICTION, ("effects", "coulomb_friction", "piston", "force"), 10.0, "N"),
    ],
    ids=["valve", "dead volume", "mass", "effect"],
)
def test_a_factor_becomes_the_rigs_own_number_with_its_interval(
    data: MachineData, parameter: FreeParameter, key: tuple[str, ...], believed: float, unit: str
) -> None:
    off = replace(result({parameter: 1.2}), deviations=(Deviation(parameter, 1.2, 0.02),))
    (made,) = corrections(data, off)
    assert (made.key, made.unit) == (key, unit)
    assert made.value == pytest.approx(1.2 * believed)
    assert made.interval is not None and made.interval[0] < 1.2 * believed < made.interval[1]


def test_a_joints_damping_is_a_factor_that_never_reaches_zero(data: MachineData) -> None:
    (made,) = corrections(data, replace(result({DAMPING: 0.0}), deviations=(Deviation(DAMPING, 0.0, 0.01),)))
    assert made.key == ("joints", "slide", "damping_factor") and made.value == pytest.approx(1e-3)


@pytest.mark.parametrize(("by", "note"), [(1.02, WITHIN_SHEET_NOTE), (0.41, BEYOND_SHEET_NOTE), (1.3, BEYOND_SHEET_NOTE)])
def test_what_was_only_refitted_has_a_note_that_is_true_of_it(data: MachineData, by: float, note: str) -> None:
    (made,) = corrections(data, replace(result({AREA: by}), refitted=((AREA, 0.01),)))
    assert made.note == note and made.value == pytest.approx(by * 2e-6)
    assert made.interval is not None and made.interval[0] < made.value < made.interval[1]


def test_a_number_of_a_law_has_the_interval_there_that_the_report_gives_it(data: MachineData) -> None:
    """A law is never quite the machine's: a thousandth, as the fit has it, would be no error of the machine's number."""
    off = replace(result({FRICTION: 13.0}), refitted=((FRICTION, 0.01),))
    (made,) = corrections(data, off)
    (said,) = small_findings([off], ())
    assert made.interval == pytest.approx((said.parameters["force"].low, said.parameters["force"].high))


def test_what_the_rig_file_does_not_hold_is_not_corrected_in_it(data: MachineData) -> None:
    drag = replace(FRICTION, effect="viscous_friction", parameter="coefficient", unit="N s/m")
    assert corrections(data, replace(result({drag: 20.0}), deviations=(Deviation(drag, 2.0, 0.1),), refitted=((drag, 0.1),))) == []


CARRYING = """
<mujoco><worldbody><body name="frame">
  <joint name="slide" type="slide" axis="1 0 0"/><geom type="sphere" size="0.05" mass="8"/>
  <body name="{load}" pos="0 0 0.1"><geom type="sphere" size="0.05" mass="4"/></body>
</body></worldbody><actuator><motor name="piston" joint="slide"/></actuator></mujoco>
"""


@pytest.mark.parametrize(
    ("load", "said", "off", "body", "mass"),
    [
        ("payload", "", 1.25, "payload", 7.0),
        ("crate", '[bodies.crate]\nmass = "4 kg"\n', 1.25, "crate", 7.0),
        ("crate", "", 1.25, "frame", 11.0),
        ("payload", "", 0.5, "frame", 2.0),  # 6 kg too many: more than the payload has
    ],
    ids=["payload", "said in the rig", "nothing said", "more than it has"],
)
def test_a_wrong_mass_is_that_of_what_is_carried_where_the_machine_says_what_that_is(
    tmp_path: Path, load: str, said: str, off: float, body: str, mass: float
) -> None:
    rig = benches.bench(tmp_path, said)
    rig.model.write_text(CARRYING.format(load=load))
    model = load_model(rig)
    (made,) = corrections(MachineData(rig, model, linkages(rig, model), (), (), {}, {}),
                          replace(result({MASS: off}), deviations=(Deviation(MASS, off, 0.01),)))  # fmt: skip
    assert made.key == ("bodies", body, "mass") and made.value == pytest.approx(mass)
    assert made.interval is not None and made.interval[0] < mass < made.interval[1]
