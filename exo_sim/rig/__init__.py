"""The nominal machine, as its owner describes it: `rig.toml` read, checked, turned into records, and written back."""

from exo_sim.rig.effect_text import EffectEntry
from exo_sim.rig.improved_text import Correction, improved
from exo_sim.rig.reading import parse, read
from exo_sim.rig.schema import (
    Ankle,
    Attachment,
    Cylinder,
    EffectSetting,
    Environment,
    JointFactors,
    Recovery,
    Rig,
    Supply,
    Valve,
    Wearer,
)

__all__ = [
    "Ankle",
    "Attachment",
    "Correction",
    "Cylinder",
    "EffectEntry",
    "EffectSetting",
    "Environment",
    "JointFactors",
    "Recovery",
    "Rig",
    "Supply",
    "Valve",
    "Wearer",
    "improved",
    "parse",
    "read",
]
