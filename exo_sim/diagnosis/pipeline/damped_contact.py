"""A dry contact whose bristles are damped, sought as it acts once the laws of friction are known.

Where the motion turns round, such a contact resists with the time integral 2 F d/k more than one that slides at once (F the dry friction,
d and k damping and stiffness of the bristles): friction turns round by d/k sooner than the motion. Slow speeds show that as another dip,
high ones as another drag, and lines about a level that is not known yet do not tell it from them. LuGre's bristles: Canudas de Wit et al.
(1995).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.policy import healthy, verdicts
from exo_sim.diagnosis.policy.priors import PREVALENCE
from exo_sim.diagnosis.selection.evidence import price_of_parameter
from exo_sim.diagnosis.selection.fitted_model import FittedModel, is_at_bound, reach_of_bound
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.physics.effects import presliding

#: Travel before sliding that fits begin at [m], and by how much sooner than the motion friction turns round [s]. Of 0.05 to 0.3 mm, and
#: firmer as the contacts of strangers are; 0.2 to 1 of sqrt(m/k), of 1.6 kg on 3.3e5 N/m and 45 kg on 3e6: 0.4 to 3.9 ms.
TRAVELS, LEADS = (2e-5, 6e-5, 2e-4), (1e-3, 3e-3)
#: Every contact has one law or the other.
PREVALENCE_OF_LAW = 0.5
#: Beside the damping that was fitted these are tried where all laws are weighed again, in units of it.
NEAR_DAMPING = (1.0, 0.7, 1.4)


@dataclass(frozen=True)
class DampedContact:
    """A contact with damped bristles.

    Attributes:
        candidate: The contact.
        near: Its numbers as fitted, and others near them, the likeliest first.
    """

    candidate: Candidate
    near: tuple[Mapping[FreeParameter, float], ...]


def damped_contact(found: FittedModel, fits: ModelFits, asked: Sequence[Candidate], level: float) -> DampedContact | None:
    """Return the damped contact with which a model explains plainly more; None where it does not, or has no dry contact.

    Args:
        found: The model.
        fits: Fits of its balance.
        asked: The candidates of the balance, of a piston: where no contact is among them, the rig knows it.
        level: Size of its dry friction [N].
    """
    contact = next((c for c in asked if c.effect == presliding.EFFECT.name), None)
    if contact is None or not found.candidates:
        return None
    others = tuple(c for c in found.candidates if c.effect != contact.effect)
    for damped in _contacts(contact.where, level):
        stiffness, damping = damped.parameters
        model = fits.fit((*others, damped), found)
        values = model.fit.values
        if damped.is_law and values[stiffness] - stiffness.low < reach_of_bound(stiffness, values[stiffness]):
            continue  # softer, if at all
        if is_at_bound(damped, model) or not is_better(model, found, fits, verdicts.SHAPE_NEEDED):
            return None
        near = tuple({stiffness: values[stiffness], damping: share * values[damping]} for share in NEAR_DAMPING)
        return DampedContact(damped, near)
    return None


def is_better(one: FittedModel, other: FittedModel, fits: ModelFits, by: float = 0.0) -> bool:
    """Return whether a model has the greater log-likelihood, by so much, parameters paid for."""
    price = price_of_parameter(fits.effective_sample_size((one, other)))
    return fits.deficit(one, other) + price * (one.parameter_count - other.parameter_count) < -by


def _contacts(where: str, level: float) -> list[Candidate]:
    """Return a contact that is as firm as any seal's, and one that is softer, which is a finding."""
    effect = presliding.EFFECT
    stiff, damped = effect.parameter("stiffness"), effect.parameter("damping")

    def number(name: str, unit: str, scale: float, low: float, high: float) -> FreeParameter:
        return FreeParameter(effect.name, where, name, unit, Target.CYLINDER, scale, low, high)

    def contact(form: str, low: float, high: float, is_law: bool) -> Candidate:
        parameters = (
            number("stiffness", stiff.unit, effect.identification.scale, low, high),
            number("damping", damped.unit, damped.typical[1], damped.low, damped.high),
        )
        tried = dict.fromkeys(min(max(level / travel, low), high) for travel in TRAVELS)
        starts = tuple((stiffness, lead * stiffness) for stiffness in tried for lead in LEADS)
        usual = PREVALENCE_OF_LAW if is_law else float(PREVALENCE)
        return Candidate(effect.name, where, form, parameters, starts, proportional=False, is_law=is_law, prevalence=usual)

    return [
        contact("firm, damped", healthy.SOFT_CONTACT, stiff.high, True),
        contact("stiffness+damping", stiff.low, healthy.SOFT_CONTACT, False),
    ]
