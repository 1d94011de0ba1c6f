"""A recording, simulated: the rig's whole machine under the recorded commands, supply and outside forces."""

from exo_sim.simulation.replay.replay import WINDOW, Replay, Run, check_belongs, replay, rms, run, usable

__all__ = ["WINDOW", "Replay", "Run", "check_belongs", "replay", "rms", "run", "usable"]
