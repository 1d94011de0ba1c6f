"""The verdict and the next experiment follow from what was found and from what could be judged."""

from __future__ import annotations

from dataclasses import replace

import benches
import pytest

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.findings import Finding, Kind, OpenQuestion, Subsystem
from exo_sim.diagnosis.outcome.verdict import distinct, next_experiment, verdict_of
from exo_sim.diagnosis.result import Verdict
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load

BOTH = {Subsystem.GAS, Subsystem.MOTION}


@pytest.fixture(scope="module", params=[True, False], ids=["with a cylinder", "without"])
def data(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> MachineData:
    rig = benches.bench(tmp_path_factory.mktemp("verdict"), cylinder=request.param)
    model = load(rig)
    return MachineData(rig, model, linkages(rig, model), (), (), {}, {})


def finding(kind: Kind, name: str = "piston_leakage", **more: tuple[str, ...]) -> Finding:
    return Finding(name, "piston", kind, "", {}, 9.0, 0.5, **more)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("kinds", "verdict"),
    [
        ([], Verdict.CONSISTENT),
        ([Kind.CALIBRATION], Verdict.CALIBRATION),
        ([Kind.CALIBRATION, Kind.SENSOR], Verdict.MISMATCH),
        ([Kind.UNKNOWN], Verdict.MISMATCH),
        ([Kind.MISSING_PHYSICS], Verdict.MISMATCH),
    ],
)
def test_the_worst_finding_decides(data: MachineData, kinds: list[Kind], verdict: Verdict) -> None:
    assert verdict_of([finding(kind) for kind in kinds], BOTH, data) is verdict


def test_what_was_not_judged_leaves_it_undetermined(data: MachineData) -> None:
    assert verdict_of([], set(), data) is Verdict.UNDETERMINED
    assert verdict_of([], {Subsystem.GAS}, data) is Verdict.UNDETERMINED
    assert verdict_of([finding(Kind.SENSOR)], set(), data) is Verdict.MISMATCH
    driven = replace(data, externally_driven=frozenset({"slide"}))
    alone = Verdict.CONSISTENT if data.rig.cylinders else Verdict.UNDETERMINED
    assert verdict_of([], {Subsystem.GAS}, driven) is alone  # nobody could judge the forces of a piston that is led


@pytest.mark.parametrize(("verdict", "status"), [("consistent", 0), ("calibration", 0), ("mismatch", 3), ("undetermined", 4)])
def test_each_verdict_has_its_exit_status(verdict: str, status: int) -> None:
    assert Verdict(verdict).exit_status == status


def test_first_of_all_look_alikes_are_to_be_separated() -> None:
    alike = finding(Kind.MISSING_PHYSICS, "coulomb_friction", ambiguous_with=("pressure_dependent_friction",))
    unknown = finding(Kind.UNKNOWN, "unknown", depends_on=("slide.position",))
    question = OpenQuestion("the gas of piston in monday", ("gas",), "its pressures hardly change")
    asked = next_experiment([unknown, alike], [question])
    assert asked is not None and asked.separates == ("coulomb_friction", "pressure_dependent_friction")
    asked = next_experiment([unknown], [question])
    assert asked is not None and "slide.position alone" in asked.do
    asked = next_experiment([finding(Kind.CALIBRATION)], [question])
    assert asked is not None and "hardly change" in asked.why
    assert next_experiment([], []) is None


def test_an_open_question_is_listed_once() -> None:
    one, other = (OpenQuestion("the gas", ("gas",), why) for why in ("no pressure", "too slow"))
    assert distinct([one, other, one]) == (one, other)
