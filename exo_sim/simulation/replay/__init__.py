"""A recording, simulated: the rig's whole machine under the recorded commands, supply and outside forces."""

from exo_sim.simulation.replay.replay import WINDOW, FreeRun, Replay, check_belongs, free_run, replay, rms, usable

__all__ = ["WINDOW", "FreeRun", "Replay", "check_belongs", "free_run", "replay", "rms", "usable"]
