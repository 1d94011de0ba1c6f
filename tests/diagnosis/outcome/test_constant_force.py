"""A constant force beside dry friction is in the improved rig as friction of two directions, where the two are not told apart."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import benches
import numpy as np
import pytest
from diagnosis import motion_runs

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.nominal_numbers import FORCE_OFFSET
from exo_sim.diagnosis.outcome.constant_force import with_constant_force
from exo_sim.diagnosis.outcome.rig_update import Part, Rank, RigUpdate
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.rig import EffectEntry, EffectSetting

OFFSET = FreeParameter(FORCE_OFFSET, "slide", FORCE_OFFSET, "N", Target.SENSOR, 1.0, -10.0, 10.0, (0.0, 1.0))
DRY = EffectEntry(EffectSetting("coulomb_friction", "piston", {"force": 14.0}), {"force": (12.0, 16.0)}, "Dry friction.")
DRAG = EffectEntry(EffectSetting("viscous_friction", "piston", {"coefficient": 40.0}), {"coefficient": (30.0, 50.0)}, "Drag.")


@pytest.fixture
def update(tmp_path: Path) -> RigUpdate:
    return RigUpdate(benches.bench(tmp_path), (Part("motion of slide", Rank.FOUND, (DRY, DRAG)),))


def judged(offset: float, alike: tuple[str, ...] = ("asymmetric_friction",), arm: float = 1.0) -> SubsystemResult[MotionModel]:
    """Return the result of a balance with a constant force at its joint, in which dry friction may be these others."""
    run = motion_runs.behind_cylinder(motion_runs.balance(np.zeros(motion_runs.TIME.size)), np.zeros((motion_runs.TIME.size, 2)))
    run = replace(run, drive=replace(run.drive, arm=np.full(motion_runs.TIME.size, arm)))
    model = MotionModel([run], motion_runs.plant(), Split({}))
    level = {"force": Estimate(14.0, "N", 12.0, 16.0)}
    dry = Finding("coulomb_friction", "piston", Kind.MISSING_PHYSICS, "", level, 9.0, 0.5, ambiguous_with=alike)
    final = FittedModel.at({OFFSET: offset})
    return SubsystemResult("slide", model, ModelFits(model, ()), SearchResult(final, final), final, findings=(dry,))


@pytest.mark.parametrize(("offset", "arm"), [(-2.5, 1.0), (0.5, -0.2)])
def test_either_direction_meets_what_friction_and_the_force_make_together(update: RigUpdate, offset: float, arm: float) -> None:
    """A joint that a piston turns backwards is pushed the other way."""
    (part,) = with_constant_force(update, [judged(offset, arm=arm)]).parts
    friction, drag = part.entries
    assert drag is DRAG and (friction.setting.name, friction.setting.where) == ("asymmetric_friction", "piston")
    assert friction.setting.parameters == {"forward": 16.5, "backward": 11.5}
    assert friction.intervals == {"forward": (14.5, 18.5), "backward": (9.5, 13.5)}


def test_no_friction_is_negative(update: RigUpdate) -> None:
    (part,) = with_constant_force(update, [judged(13.0)]).parts
    assert part.entries[0].setting.parameters == {"forward": 1.0, "backward": 27.0}
    assert part.entries[0].intervals == {"forward": (0.0, 3.0), "backward": (25.0, 29.0)}


@pytest.mark.parametrize(("offset", "alike"), [(0.0, ("asymmetric_friction",)), (-2.5, ())], ids=["no force", "told apart"])
def test_else_an_update_stays_as_it_is(update: RigUpdate, offset: float, alike: tuple[str, ...]) -> None:
    assert with_constant_force(update, [judged(offset, alike)]) is update


def test_friction_that_the_rig_has_stays(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path, '[effects.coulomb_friction.piston]\nforce = "5 N"\n')
    update = RigUpdate(rig, (Part("motion of slide", Rank.FOUND, (DRY,)),))
    assert with_constant_force(update, [judged(-2.5)]) is update
