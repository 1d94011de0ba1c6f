"""Somebody's own controller: any object with `reset(context)` and `act(observation)`.

    class Impedance:
        period = 0.002                                   # optional: seconds between two calls of act; 0.002 where it is not given
        def reset(self, context): ...                    # before the first step; what it is given is a `Context`
        def act(self, observation): return {...}         # name of a signal to its value, "time" in seconds; commands until the next call

Commands are a dictionary, or numbers in the order of `context.cylinders`: `"knee_l"` or `"knee_l.valve_command"` opens that cylinder's
valve, -1 to 1 (where its edges are independent `"knee_l.valve_command_1"` and `_2` open those of each chamber); `"knee_l.torque"` asks
for a joint's torque [N m] (of a sliding joint, its force [N]), which the built-in force loop then makes. One kind at a time; what
is left out is 0.
"""

from exo_sim.control.user_controller.commands import TORQUES, VALVES, Commands, read
from exo_sim.control.user_controller.loading import is_path, load, of
from exo_sim.control.user_controller.protocol import PERIOD, Context, Controller, period_of
from exo_sim.control.user_controller.running import Interrupted, RunningController

__all__ = [
    "PERIOD",
    "TORQUES",
    "VALVES",
    "Commands",
    "Context",
    "Controller",
    "Interrupted",
    "RunningController",
    "is_path",
    "load",
    "of",
    "period_of",
    "read",
]
