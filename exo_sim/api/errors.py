"""The one tree of errors, under the name that users catch."""

from exo_sim.errors import ExoSimError

__all__ = ["ExoSimError"]
