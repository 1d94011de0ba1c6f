"""Damped bristles of a dry contact are seen where friction turns round sooner than the motion, and friction is right beside them."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import motion_runs
from diagnosis.motion_runs import TIME

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.pipeline.damped_contact import DampedContact, damped_contact
from exo_sim.diagnosis.selection.family_search import FamilySearch
from exo_sim.diagnosis.selection.fitted_model import SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.subsystems.motion.candidates import candidates
from exo_sim.diagnosis.subsystems.motion.family import motion_family
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.subsystems.motion.nuisances import nuisance_parameters
from exo_sim.diagnosis.subsystems.motion.scales import MotionScales
from exo_sim.diagnosis.subsystems.motion.smoothing import smoothed_alike

COULOMB, BREAKAWAY, DIP, VISCOUS = 30.0, 50.0, 0.03, 80.0
STIFFNESS = BREAKAWAY / 4e-5
#: Speed about which the damping fades [m/s].
FADING = 0.02
#: Steps of the truth in each of the recording.
FINE = 50


def friction(lead: float, fine: int = FINE) -> np.ndarray:
    """Return what LuGre's contact and a film resist the motion with [N]; damping over stiffness of its bristles is `lead` [s]."""
    step = float(TIME[1] - TIME[0]) / fine
    time = np.arange((TIME.size - 1) * fine + 1) * step
    velocity = 0.15 * np.cos(3.0 * time) + 0.146 * np.cos(7.3 * time)
    level = COULOMB + (BREAKAWAY - COULOMB) * np.exp(-((velocity / DIP) ** 2))
    z, bristles, speeds = 0.0, np.empty(time.size), np.empty(time.size)
    for i, (v, g) in enumerate(zip(velocity.tolist(), level.tolist(), strict=True)):
        settled = g / STIFFNESS if v > 0.0 else -g / STIFFNESS
        after = settled + (z - settled) * np.exp(-STIFFNESS * abs(v) * step / g)
        bristles[i], speeds[i], z = after, (after - z) / step, after
    speeds[0] = 0.0
    fading = np.exp(-((velocity / FADING) ** 2))
    whole = STIFFNESS * (bristles + lead * fading * speeds) + VISCOUS * velocity
    sampled = np.convolve(whole, np.ones(fine) / fine, mode="same")[::fine]
    return smoothed_alike(TIME, sampled)


def searched(lead: float, noise: float = 0.1) -> tuple[SearchResult, DampedContact | None, SearchResult | None]:
    """Return what is found without a damped contact, that contact, and what is found with it."""
    run = motion_runs.behind_cylinder(motion_runs.balance(friction(lead), noise), np.zeros((TIME.size, 2)))
    model = MotionModel([run], motion_runs.plant(), Split({}))
    asked = candidates(model.runs, model.nominal, model.where)
    nuisances = nuisance_parameters(model.runs, model.nominal, model.where)
    fits = ModelFits(model, nuisances, cheap=True)
    found = FamilySearch(fits, motion_family(model, nuisances, asked), model.discrepancy_basis()).run()
    contact = damped_contact(found.final, fits, asked, MotionScales.of(model).level)
    if contact is None:
        return found, None, None
    family = motion_family(model, nuisances, (*asked, contact.candidate), contacts=contact.near)
    return found, contact, FamilySearch(ModelFits(model, nuisances, cheap=True), family, model.discrepancy_basis()).run()


def numbers(found: SearchResult) -> dict[str, float]:
    return {q.parameter: found.final.fit.values[q] for c in found.final.candidates for q in c.parameters}


def test_friction_is_right_beside_bristles_that_are_damped() -> None:
    before, contact, after = searched(lead=3e-3)
    assert contact is not None and after is not None
    assert contact.candidate.is_law
    assert after.final.fit.sse < 0.1 * before.final.fit.sse
    found = numbers(after)
    assert 0.3e-3 < found["damping"] / found["stiffness"] < 3e-3  # behind the filter of a balance less of it is more stiffness
    assert {c.effect for c in after.final.candidates if not c.is_law} == {"coulomb_friction", "stribeck_friction", "viscous_friction"}
    assert found["force"] == pytest.approx(COULOMB, rel=0.1) and found["coefficient"] == pytest.approx(VISCOUS, rel=0.1)


def test_of_bristles_that_are_not_damped_the_stiffness_is_found() -> None:
    """Firmer than any contact that is weighed along lines, which slides over 40 um as well, and not at once."""
    _, contact, after = searched(lead=0.0)
    assert contact is not None and after is not None
    found = numbers(after)
    assert found["stiffness"] == pytest.approx(STIFFNESS, rel=0.1) and found["damping"] < 1e-4 * STIFFNESS


def test_what_has_no_dry_friction_has_no_contact() -> None:
    run = motion_runs.behind_cylinder(motion_runs.balance(np.zeros(TIME.size), 0.1), np.zeros((TIME.size, 2)))
    model = MotionModel([run], motion_runs.plant(), Split({}))
    fits = ModelFits(model, nuisance_parameters(model.runs, model.nominal, model.where), cheap=True)
    asked = candidates(model.runs, model.nominal, model.where)
    assert damped_contact(fits.fit(()), fits, asked, 1.0) is None
