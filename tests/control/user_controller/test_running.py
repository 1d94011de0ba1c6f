"""A controller in use: whatever comes out of somebody's code is one line."""

import sys
from dataclasses import replace
from typing import Any

import pytest

from exo_sim.control import user_controller
from exo_sim.errors import ScenarioError


class Odd:
    """What cannot be told, counted or called by a name."""

    def __str__(self) -> str:
        raise ZeroDivisionError("odd")

    __float__ = __str__


class OddError(Exception):
    """What cannot even be told."""

    def __str__(self) -> str:
        raise ZeroDivisionError("odd")


@pytest.mark.parametrize("error", [SystemExit(0), SystemExit("done"), GeneratorExit(), BaseException("odd"), OddError(), StopIteration()])
def test_whatever_comes_out_of_somebodys_code_is_one_line(context, error):
    class Mine:
        def reset(self, context: object) -> None:
            if context is None:
                raise error

        def act(self, observation: object) -> None:
            raise error

    with pytest.raises(ScenarioError, match=rf"test_running\.py:\d+: {type(error).__name__}.*, in act of Mine at 0\.250 s"):
        user_controller.RunningController(Mine(), context).act({"time": 0.25})
    with pytest.raises(ScenarioError, match=f"{type(error).__name__}.*, in reset of Mine"):
        user_controller.RunningController(Mine(), None).reset()  # type: ignore[arg-type]


@pytest.mark.parametrize("returned", [{"knee_l": 10**400}, {"knee_l": Odd()}, {Odd(): 0.0}, [Odd()] * 4])
def test_what_cannot_be_read_as_commands_is_one_line(context, returned):
    class Mine:
        def reset(self, context: object) -> None: ...

        def act(self, observation: Any) -> Any:
            observation.clear()
            return returned

    with pytest.raises(
        ScenarioError, match=r"controller Mine, at 0\.250 s: what act returned cannot be read \((Overflow|ZeroDivision)Error"
    ):
        user_controller.RunningController(Mine(), context).act({"time": 0.25})


def test_an_interrupt_goes_through_somebodys_code(context):
    class Mine:
        def reset(self, context: object) -> None: ...

        def act(self, observation: object) -> None:
            assert user_controller.RunningController.is_asked(sys._getframe())
            raise KeyboardInterrupt

    assert not user_controller.RunningController.is_asked(sys._getframe())
    with pytest.raises(KeyboardInterrupt):
        user_controller.RunningController(Mine(), context).act({"time": 0.25})


def test_what_fails_inside_names_file_and_line(tmp_path, context):
    mine = tmp_path / "mine.py"
    mine.write_text("class Mine:\n    def reset(self, context): pass\n    def act(self, observation):\n        return 1 / 0\n")
    asked = user_controller.RunningController(user_controller.load(f"{mine}:Mine"), context, "mine.py:Mine")
    asked.reset()
    with pytest.raises(ScenarioError, match=r"mine\.py:4: ZeroDivisionError: division by zero, in act of mine\.py:Mine at 0\.250 s"):
        asked.act({"time": 0.25})


def test_commands_that_look_like_torques_are_remarked_on(context):
    class Strong:
        def reset(self, context):
            pass

        def act(self, observation):
            return {"knee_l": 30.0}

    asked = user_controller.RunningController(Strong(), context)
    asked.reset()
    for i in range(12):
        asked.act({"time": 0.001 * i})
    assert "knee_l.torque" in asked.remarks()[0]


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("knee_l.velo", '; did you mean "knee_l.velocity"?'), ("slide", "; there is: ankle_l, ankle_r, hip_l, hip_r, knee_l, knee_r"),
        ("knees_l", '; did you mean "knee_l"'), ("of.mine", "s"), ("knee_l", "s"), (3, "s"),
    ],
)  # fmt: skip
def test_a_name_that_is_not_there_is_answered_with_near_ones(context, name, says):
    class Mine:
        def reset(self, context: object) -> None: ...

        def act(self, observation: Any) -> Any:
            return observation[name]

    seen = replace(context, signals=("knee_l.velocity", "knee_l.position"))
    with pytest.raises(ScenarioError, match=r"KeyError.* in act of Mine at 0\.250 s") as caught:
        user_controller.RunningController(Mine(), seen).act({"time": 0.25})
    assert says in str(caught.value).partition("0.250 ")[2] and (says != "s" or str(caught.value).endswith("0.250 s"))
