"""One machine as its owner believes it to be: `rig.toml` read, checked, turned into records, and written back."""

from exo_sim.rig.reading import parse, read
from exo_sim.rig.schema import Ankle, Cylinder, EffectSetting, Environment, Rig, Supply, Wearer

__all__ = ["Ankle", "Cylinder", "EffectSetting", "Environment", "Rig", "Supply", "Wearer", "parse", "read"]
