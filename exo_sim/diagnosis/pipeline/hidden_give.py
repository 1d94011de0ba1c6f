"""A transmission whose give shows in the gas only once the friction of its piston is known.

How far it yields is the force that passes through it, which is that of the pressures less what resists the piston. A search of the gas that
knows nothing of that resistance misjudges the give by it over the stiffness, at every reversal the other way round, and may find numbers of
the rig (dead volumes) that stand in for it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from exo_sim.diagnosis.coupling.piston_friction import Friction, friction_of_pistons, is_soft
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.policy.verdicts import PLAIN_ODDS
from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.fitted_model import FittedModel, is_at_bound, is_more_than_healthy
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.gas.candidates import candidates
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.physics.transmission import gives


def friction_behind_hidden_give(
    gas: Sequence[SubsystemResult[GasModel]], motion: Sequence[SubsystemResult[MotionModel]], split: Split, joints: Mapping[str, str]
) -> Friction:
    """Return the friction of each piston beside which its gas asks for a transmission that gives, though without it none was found.

    Only first looks are taken, beside what was found: they are to say whether the gas is worth searching anew.

    Args:
        gas, motion: What was found of the gas, and of the forces under it.
        split: The division of time.
        joints: By cylinder, the joint that it drives.
    """
    friction = friction_of_pistons(motion)
    return {one.where: friction[one.where] for one in gas if one.where in friction and _asks(one, friction, split, joints[one.where])}


def _asks(one: SubsystemResult[GasModel], friction: Friction, split: Split, joint: str) -> bool:
    """Return whether a gas that leaves more than noise is surely predicted better with a transmission that gives."""
    end, found = one.search.final, one.model
    if one.is_empty or one.search.interrupted or gives(one.plant_of(end).cylinder[0]):
        return False
    plant = found.nominal.with_values(friction[one.where])
    model = GasModel(found.all_runs, plant, split)
    fits, asked = ModelFits(model, one.fits.nuisances), candidates(plant, found.all_runs, one.where, joint)
    compared = Comparisons(fits, one.search.baseline, len(asked), model.practical_significance)
    begun = FittedModel(end.candidates, end.fit)
    if compared.is_clean(begun):
        return False
    looks = [(c, fits.look((*end.candidates, c), begun)) for c in asked if is_soft(c.effect)]
    shown = [look for c, look in looks if is_more_than_healthy(c, look) and not is_at_bound(c, look)]
    evidence = [compared.evidence(begun, look) for look in shown]
    return any(max(one.log10_odds, one.beside_discrepancy) > PLAIN_ODDS for one in evidence)
