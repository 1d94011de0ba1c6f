"""What moving the joints costs the wearer, estimated from joint work.

Muscles that shorten do a joule of work for four of food, muscles that are stretched take one for 1.2 joules that they absorb (Margaria
1968, Internationale Zeitschrift fuer angewandte Physiologie 25:339); beside it stands what standing costs. Joint work counts too much:
tendons give back at the ankle what they stored, and muscles over two joints carry work from one to the other (Sasaki, Neptune and Kautz
2009, Journal of Experimental Biology 212:738). It also counts too little: holding a moment costs food and does no work. So the bounds are
wide; the share that is returned is this project's own guess. The foot below the ankle counts as a joint where it gives work, as with
Zelik, Takahashi and Sawicki 2015, Journal of Experimental Biology 218:876; what heel and sole absorb costs nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

#: Work done over food spent, shortening and being stretched (Margaria 1968).
SHORTENING, STRETCHED = 0.25, 1.20
#: Food spent while standing still [W/kg] (Weyand, Smith, Puyau and Butte 2010, Journal of Experimental Biology 213:3972).
STANDING = 1.3
#: Share of joint work that comes from tendons and from other joints: none, and the most that is thought of; the estimate takes half.
RETURNED = 0.6
MODEL = (
    "standing 1.3 W/kg, and joint work of hips, knees, ankles and feet over muscle efficiency (0.25 and -1.20, Margaria 1968); "
    "value: 30 % of the work comes from tendons and muscles over two joints, low: 60 %, high: none"
)


@dataclass(frozen=True)
class Metabolic:
    """An estimate of metabolic power and its bounds [W]."""

    value: float
    low: float
    high: float

    def as_json(self) -> dict[str, float | str]:
        """Return it as the contract has it."""
        return {"value": self.value, "low": self.low, "high": self.high, "model": MODEL}


def power(positive: float, negative: float, mass: float) -> Metabolic:
    """Return the wearer's metabolic power.

    Args:
        positive, negative: Mean power that the joints give, and take (not positive) [W].
        mass: Of the wearer's body, without load [kg].
    """
    work = positive / SHORTENING - negative / STRETCHED
    rest = STANDING * mass
    return Metabolic(rest + (1.0 - 0.5 * RETURNED) * work, rest + (1.0 - RETURNED) * work, rest + work)


def published(body: float, load: float, speed: float) -> float:
    """Return metabolic power of level walking with a backpack [W], as measured on soldiers.

    Pandolf, Givoni and Goldman 1977, Journal of Applied Physiology 43:577.

    Args:
        body, load: [kg].
        speed: [m/s]; the equation was fitted to 0.7 m/s and more.
    """
    return 1.5 * body + 2.0 * (body + load) * (load / body) ** 2 + 1.5 * (body + load) * speed**2
