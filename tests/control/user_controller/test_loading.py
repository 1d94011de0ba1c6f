"""A controller from a file, a class or an object; what is none is one line."""

import os
from pathlib import Path

import pytest

from exo_sim.control import user_controller
from exo_sim.errors import ScenarioError


def write(path: Path, body: str) -> Path:
    path.write_text("class Mine:\n    def reset(self, context): pass\n    def act(self, observation):\n" + body)
    return path


def test_a_file_is_loaded_with_or_without_the_name_of_the_class(tmp_path):
    path = write(tmp_path / "mine.py", "        return {}\n")
    assert user_controller.load(f"{path}:Mine").act({}) == {}
    assert user_controller.load(str(path)).act({}) == {}
    assert user_controller.is_path("mine.py:Mine") and user_controller.is_path("mine.py") and not user_controller.is_path("model")


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
        ("def mine(observation):\n    return 0.1\n", "mine", r"while making .*a class that needs no arguments, with reset"),
    ],
)
def test_a_file_that_cannot_be_loaded_is_one_line(tmp_path, text, name, hint):
    (tmp_path / "mine.py").write_text(text)
    with pytest.raises(ScenarioError, match=hint) as error:
        user_controller.load(f"{tmp_path / 'mine.py'}:{name}")
    assert "\n" not in str(error.value)
    with pytest.raises(ScenarioError, match=r'did you mean "mine\.py"'):
        user_controller.load(f"{tmp_path / 'mines.py'}:Mine")


def test_a_pipe_or_a_device_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "mine.py")
    with pytest.raises(ScenarioError, match=r'mine\.py" cannot be read: it is a pipe'):
        user_controller.load(f"{tmp_path / 'mine.py'}:Mine")
    (tmp_path / "zero.py").symlink_to("/dev/zero")
    with pytest.raises(ScenarioError, match="it is a device"):
        user_controller.load(str(tmp_path / "zero.py"))


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
        user_controller.load(f"{tmp_path}/mine.py:Mine")


def test_a_file_that_is_no_source_is_named(tmp_path):
    (tmp_path / "mine.py").write_bytes(b"class Mine:\0")
    with pytest.raises(ScenarioError, match=r"controller .*/mine\.py: SyntaxError: .*null bytes"):
        user_controller.load(f"{tmp_path}/mine.py:Mine")
