"""A pneumatic exoskeleton in MuJoCo, held against real recordings."""

__version__ = "0.1.0"
