"""Somebody's own controller: loading, what it may return, and what goes wrong in it, in one line each."""

import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.control import own
from exo_sim.errors import ScenarioError


@pytest.fixture(scope="module")
def context(repository):
    rig = rigs.read(repository / "exo_sim" / "assets" / "exo.toml")
    joints = tuple(f"{joint}_{side}" for side in "lr" for joint in ("hip", "knee", "ankle"))
    return own.Context(rig, tuple(rig.cylinders), joints, (), 0.002, 0.001, 1.0)


def write(path: Path, body: str) -> Path:
    path.write_text("class Mine:\n    def reset(self, context): pass\n    def act(self, observation):\n" + body)
    return path


def test_commands_by_name_or_in_the_order_of_the_cylinders(context):
    assert context.cylinders == ("hip_l", "knee_l", "hip_r", "knee_r")
    for returned in ({"knee_l": 0.5, "hip_r": -1}, {"knee_l.valve_command": 0.5, "hip_r": -1.0}, [0.0, 0.5, -1.0, 0.0]):
        found = own.read(returned, context)
        assert found.kind == own.VALVES
        np.testing.assert_array_equal(found.values, [0.0, 0.5, -1.0, 0.0])
    found = own.read({"knee_r.torque": 20.0, "ankle_l": 3.0}, context)
    assert found.kind == own.TORQUES
    np.testing.assert_array_equal(found.values, [0.0, 0.0, 3.0, 0.0, 20.0, 0.0])
    assert own.read({}, context, own.TORQUES).kind == own.TORQUES


@pytest.mark.parametrize(
    ("returned", "hint"),
    [
        (None, "returned nothing"),
        ({"kne_l": 0.5}, 'did you mean "knee_l"'),
        ({"knee_l.torque": 5.0, "hip_l": 0.5}, "one kind"),
        ({"knee_l": "much"}, "not a number"),
        ({"knee_l": float("nan")}, "nan"),
        ([0.1, 0.2], "2 numbers"),
        (object(), "returned a object"),
    ],
)
def test_what_is_no_command_is_said(context, returned, hint):
    with pytest.raises(ScenarioError, match=hint):
        own.read(returned, context)


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

    with pytest.raises(ScenarioError, match=rf"test_own\.py:\d+: {type(error).__name__}.*, in act of Mine at 0\.250 s"):
        own.RunningController(Mine(), context).act({"time": 0.25})
    with pytest.raises(ScenarioError, match=f"{type(error).__name__}.*, in reset of Mine"):
        own.RunningController(Mine(), None).reset()  # type: ignore[arg-type]


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
        own.RunningController(Mine(), context).act({"time": 0.25})


def test_an_interrupt_goes_through_somebodys_code(context):
    class Mine:
        def reset(self, context: object) -> None: ...

        def act(self, observation: object) -> None:
            assert own.RunningController.is_asked(sys._getframe())
            raise KeyboardInterrupt

    assert not own.RunningController.is_asked(sys._getframe())
    with pytest.raises(KeyboardInterrupt):
        own.RunningController(Mine(), context).act({"time": 0.25})


def test_a_file_is_loaded_with_or_without_the_name_of_the_class(tmp_path):
    path = write(tmp_path / "mine.py", "        return {}\n")
    assert own.load(f"{path}:Mine").act({}) == {}
    assert own.load(str(path)).act({}) == {}
    assert own.is_path("mine.py:Mine") and own.is_path("mine.py") and not own.is_path("model")


@pytest.mark.parametrize(
    ("text", "name", "hint"),
    [
        ("class Mine:\n    pass\n", "Mine", r"no method reset\(self, context\)"),
        ("class Mine:\n    def reset(self, context): pass\n", "Mine", r"no method act\(self, observation\)"),
        ("class Mine:\n    def reset(self, c): pass\n    def act(self, o): pass\n", "Min", 'did you mean "Mine"'),
        ("import nothing_there\n", "Mine", r"mine\.py:1: ModuleNotFoundError"),
        ("\nclass Mine(:\n", "Mine", r"mine\.py:2: SyntaxError"),
        ("import sys\nsys.exit(0)\n", "Mine", r"mine\.py:2: SystemExit: 0"),
        ("class Mine:\n    def __init__(self): raise SystemExit\n    reset = act = None\n", "Mine", r"mine\.py:2: SystemExit: , while"),
        ("class Mine:\n    def __init__(self, a): pass\n    reset = act = __init__\n", "Mine", "while making"),
    ],
)
def test_a_file_that_cannot_be_loaded_is_one_line(tmp_path, text, name, hint):
    (tmp_path / "mine.py").write_text(text)
    with pytest.raises(ScenarioError, match=hint) as error:
        own.load(f"{tmp_path / 'mine.py'}:{name}")
    assert "\n" not in str(error.value)
    with pytest.raises(ScenarioError, match=r'did you mean "mine\.py"'):
        own.load(f"{tmp_path / 'mines.py'}:Mine")


def test_what_fails_inside_names_file_and_line(tmp_path, context):
    mine = write(tmp_path / "mine.py", "        return 1 / 0\n")
    asked = own.RunningController(own.load(f"{mine}:Mine"), context, "mine.py:Mine")
    asked.reset()
    with pytest.raises(ScenarioError, match=r"mine\.py:4: ZeroDivisionError: division by zero, in act of mine\.py:Mine at 0\.250 s"):
        asked.act({"time": 0.25})


def test_the_time_between_calls_is_whole_steps():
    class Slow:
        period: Any = 0.01

    assert own.period_of(Slow(), 0.001, "Slow") == 10
    assert own.period_of(object(), 0.001, "it") == 2
    for wrong in (0.0001, "10 ms", True, float("nan")):
        setattr(Slow, "period", wrong)  # noqa: B010
        with pytest.raises(ScenarioError, match="seconds between two calls"):
            own.period_of(Slow(), 0.001, "Slow")


def test_commands_that_look_like_torques_are_remarked_on(context):
    class Strong:
        def reset(self, context):
            pass

        def act(self, observation):
            return {"knee_l": 30.0}

    asked = own.RunningController(Strong(), context)
    asked.reset()
    for i in range(12):
        asked.act({"time": 0.001 * i})
    assert "knee_l.torque" in asked.remarks()[0]


def test_a_pipe_or_a_device_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "mine.py")
    with pytest.raises(ScenarioError, match=r'mine\.py" cannot be read: it is a pipe'):
        own.load(f"{tmp_path / 'mine.py'}:Mine")
    (tmp_path / "zero.py").symlink_to("/dev/zero")
    with pytest.raises(ScenarioError, match="it is a device"):
        own.load(str(tmp_path / "zero.py"))


@pytest.mark.parametrize(
    "body",
    [
        "class Mine:\n    def __getattr__(self, name): raise RuntimeError(name)\n",
        "class Mine:\n    act = property(lambda self: 1 / 0)\n    def reset(self, context): pass\n",
        "class Kind(type):\n    act = property(lambda self: 1 / 0)\nclass Mine(metaclass=Kind): pass\n",
        "import sys\nclass Mine:\n    reset = property(lambda self: sys.exit(0))\n    def act(self, o): pass\n",
        "def __getattr__(name):\n    if name == 'Mine': raise KeyError(name)\n    raise AttributeError(name)\n",
    ],
)
def test_one_that_fails_when_it_is_looked_at_is_one_line(tmp_path, body):
    (tmp_path / "mine.py").write_text(body)
    with pytest.raises(ScenarioError, match=r"controller .*mine\.py:\d+: \w+"):
        own.load(f"{tmp_path}/mine.py:Mine")


class Unshowable:
    def __repr__(self) -> str:
        raise ValueError


@pytest.mark.parametrize("period", [0, -1.0, float("nan"), "1 ms", None, True, 2.0, 10**400, np.float32("nan"), 1j, Unshowable()])
def test_a_period_that_is_none_is_said(period):
    with pytest.raises(ScenarioError, match="write seconds between two calls"):
        own.period_of(type("Mine", (), {"period": period}), 0.001, "mine")


def test_a_period_may_be_any_number_and_may_not_fail():
    assert own.period_of(type("Mine", (), {"period": np.float32(0.01)}), 0.001, "mine") == 10
    assert own.period_of(type("Mine", (), {}), 0.001, "mine") == 2
    with pytest.raises(ScenarioError, match=r'ZeroDivisionError.*when it was asked for "period"'):
        own.period_of(type("Mine", (), {"period": property(lambda self: 1 / 0)})(), 0.001, "mine")


def test_a_file_that_is_no_source_is_named(tmp_path):
    (tmp_path / "mine.py").write_bytes(b"class Mine:\0")
    with pytest.raises(ScenarioError, match=r"controller .*/mine\.py: SyntaxError: .*null bytes"):
        own.load(f"{tmp_path}/mine.py:Mine")
