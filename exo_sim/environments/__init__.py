"""The walking machine as a task for learning: `load` gives a dm_env environment; importing this registers the same in Gymnasium.

    from exo_sim import environments
    environment = environments.load("level_walk", payload="34 kg")      # dm_env, built on dm_control.rl.control

    import gymnasium, exo_sim.environments
    environment = gymnasium.make("exo_sim/LevelWalk-v0", payload="34 kg")
"""

from __future__ import annotations

from typing import Any

from exo_sim.errors import ModelError
from exo_sim.gait import scenario as scenarios


def load(scenario: str = "level_walk", **settings: Any) -> Any:
    """Return a `dm_control.rl.control.Environment`.

    Args:
        scenario: One of `exo.scenarios()`, or a scenario file.
        settings: As `environments.episode.Episode` takes them: rig, payload, speed, actions, control_timestep, time_limit, random_start,
            seed.

    Raises:
        ExoSimError: one line that says what is wrong with scenario, rig or settings, or that dm_control is missing.
    """
    try:
        from exo_sim.environments.dm import environment
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] not in ("dm_control", "dm_env", "labmaze"):
            raise
        raise ModelError(
            "dm_env environments need dm_control: pip install dm-control, which works up to Python 3.12; the same environment is "
            f'gymnasium.make("{gymnasium_id(scenario)}") on any Python (pip install "exo-sim-pneumatic[gymnasium]")'
        ) from None

    return environment(scenario, **settings)


def gymnasium_id(scenario: str) -> str:
    """Return what a scenario is called in Gymnasium: "level_walk" is "exo_sim/LevelWalk-v0"."""
    return f"exo_sim/{''.join(word.title() for word in scenario.split('_'))}-v0"


def register() -> None:
    """Register every built-in scenario in Gymnasium; does nothing where Gymnasium is not installed, or has them already."""
    try:
        import gymnasium
    except ImportError:
        return
    for name in scenarios.names():
        if (key := gymnasium_id(name)) not in gymnasium.registry:
            gymnasium.register(id=key, entry_point="exo_sim.environments.gym:WalkEnv", kwargs={"scenario": name})


register()
