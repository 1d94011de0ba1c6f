"""Ctrl-C that a library turns into something else is an interrupt all the same."""

from __future__ import annotations

import ctypes
import signal
import time

import click
import pytest

from exo_sim.cli import interrupts, main
from exo_sim.cli.frame import program


@pytest.fixture(autouse=True)
def raised():
    """Raise interrupts as in the foreground; a shell that starts the tests behind itself has them ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def verb(monkeypatch):
    """Give what makes a function the verb `scenarios`."""

    def put(function):
        command = click.Command("scenarios", callback=function)
        monkeypatch.setattr(program, "get_command", lambda context, name: command)

    return put


def interrupted_in_a_callback():
    """Be interrupted where Python cannot raise: in a function that C calls."""

    @ctypes.CFUNCTYPE(None)
    def called():
        signal.raise_signal(signal.SIGINT)
        for _ in range(1000):
            pass

    called()
    time.sleep(60.0)  # ended by the interrupt


def test_one_that_became_another_error_ends_with_130(verb, capsys):
    def compile_something():
        try:
            signal.raise_signal(signal.SIGINT)
            time.sleep(60.0)  # ended by the interrupt
        except KeyboardInterrupt:
            raise RuntimeError("no compiled object yet") from None

    verb(compile_something)
    assert main(["scenarios"]) == 130
    assert capsys.readouterr().err == "exo-sim: interrupted\n"


def test_one_that_a_callback_swallows_is_raised_again(verb, capfd):
    verb(interrupted_in_a_callback)
    assert main(["scenarios"]) == 130
    assert capfd.readouterr().err == "exo-sim: interrupted\n"


def test_without_one_an_error_of_ours_stays_one(verb, capsys):
    def fail():
        raise RuntimeError("no compiled object yet")

    verb(fail)
    assert main(["scenarios"]) == 70
    assert "RuntimeError" in capsys.readouterr().err


def test_what_was_there_before_is_put_back_and_what_is_ignored_stays_ignored():
    before = signal.getsignal(signal.SIGINT)
    with interrupts.noted():
        pass
    assert signal.getsignal(signal.SIGINT) is before
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with interrupts.noted() as came:
            signal.raise_signal(signal.SIGINT)
            assert not came()
    finally:
        signal.signal(signal.SIGINT, before)
