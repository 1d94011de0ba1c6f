"""Long runs are written piece by piece: the same numbers as in one piece, memory that stays, and what was done is there after a kill."""

import dataclasses
import itertools
import signal
import subprocess
import sys
import time
import tracemalloc

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.cli import main
from exo_sim.recording import Recording, read
from exo_sim.rig import EffectSetting
from exo_sim.simulation import streamed_run
from exo_sim.simulation.sensors import Observer, observe
from exo_sim.simulation.summary import Summary, summarise
from exo_sim.simulation.walk import Request
from exo_sim.simulation.worn import Simulation

CYCLES = 8


@pytest.fixture(scope="module")
def exo(repository):
    return rigs.read(repository / "assets" / "exo_250_psi.toml")


def simulation(exo, **request):
    return Simulation(exo, Request(**{"scenario": "level_walk", "assist": "vented", "cycles": CYCLES, **request}))


@pytest.fixture(scope="module")
def whole(exo):
    return simulation(exo).run()


@pytest.fixture(scope="module")
def pieces(exo):
    return list(simulation(exo).pieces(most=100))


def assert_same(got, wanted):
    """Compare nested numbers; sums that are taken in another order differ in the last bits."""
    if isinstance(wanted, dict):
        assert list(got) == list(wanted)
        for key in wanted:
            assert_same(got[key], wanted[key])
    elif isinstance(wanted, list):
        for one, other in zip(got, wanted, strict=True):
            assert_same(one, other)
    else:
        assert got == pytest.approx(wanted, rel=1e-9, abs=1e-9) if isinstance(wanted, float) else got == wanted


def test_pieces_are_whole_cycles_and_the_same_to_the_bit(whole, pieces):
    per_cycle = whole.motion.period / whole.step
    assert len(pieces) == 3
    assert [piece.first for piece in pieces] == [0, round(3 * per_cycle), round(6 * per_cycle)]
    for key, column in whole.columns.items():
        assert np.array_equal(np.concatenate([piece.columns[key] for piece in pieces]), column), key
    for name in ("time", "poses", "wrench", "weight"):
        assert np.array_equal(np.concatenate([getattr(piece, name) for piece in pieces]), getattr(whole, name)), name


def test_the_summary_of_pieces_is_that_of_the_whole(whole, pieces):
    summary = Summary()
    for piece in pieces:
        summary.add(piece)
    assert_same(summary.numbers(), summarise(whole))


@pytest.mark.parametrize("cycles", [1, 2, 3, 4])
def test_few_cycles_leave_out_what_they_did(exo, cycles):
    (walk,) = simulation(exo, cycles=cycles).pieces()
    assert summarise(walk)["simulated_s"] == pytest.approx(cycles * walk.motion.period, abs=2 * walk.step)


@pytest.mark.parametrize("seconds", [0.03, -0.03])
def test_late_and_early_sensors_look_beyond_a_piece(exo, seconds):
    rig = dataclasses.replace(exo, effects=(EffectSetting("sensor_delay", "a.force", {"seconds": seconds}),))
    time = np.arange(1000, dtype=float) * 1e-3
    signal_ = np.cumsum(np.random.default_rng(0).standard_normal(1000))
    recording = Recording("r", time, {"a.force": signal_, "b.force": -signal_}, {"a.force": "N", "b.force": "N"})
    observer, edges = Observer(rig), [0.0, 0.2, 0.3, 0.7, 2.0]
    shown = [observer.add(recording.span(*edge)) for edge in itertools.pairwise(edges)]
    shown += [rest for rest in [observer.rest()] if rest is not None]
    wanted = observe(recording, rig)
    assert np.array_equal(np.concatenate([piece.time for piece in shown]), time)
    for key in wanted.columns:
        assert np.array_equal(np.concatenate([piece[key] for piece in shown]), wanted[key])


def test_files_written_in_pieces_hold_what_those_written_at_once_do(exo, tmp_path):
    numbers = {}
    for name, most in (("pieces", 100), ("whole", 10**9)):
        numbers[name], interrupted = streamed_run.run(simulation(exo), tmp_path / f"{name}.rrd", tmp_path / f"{name}.parquet", most=most)
        assert not interrupted
    assert sorted(path.name for path in tmp_path.iterdir()) == ["pieces.parquet", "pieces.rrd", "whole.parquet", "whole.rrd"]
    assert_same(numbers["pieces"], numbers["whole"])
    for ending in (".rrd", ".parquet"):
        one, other = (read(tmp_path / f"{name}{ending}") for name in numbers)
        assert one.findings == other.findings
        assert one.recording.metadata == other.recording.metadata and one.recording.units == other.recording.units
        assert np.array_equal(one.recording.time, other.recording.time)
        for key, values in other.recording.columns.items():
            assert np.array_equal(one.recording[key], values), key


def test_a_recording_of_many_pieces_has_no_list_of_contents_and_reads_the_same(exo, tmp_path, monkeypatch):
    for name, most in (("short", 16), ("long", 0)):
        monkeypatch.setattr(streamed_run, "_LONG", most)
        streamed_run.run(simulation(exo), tmp_path / f"{name}.rrd", tmp_path / f"{name}.parquet", most=100)
    short, long = (read(tmp_path / f"{name}.rrd") for name in ("short", "long"))
    assert short.findings == long.findings and list(short.recording.columns) == list(long.recording.columns)
    assert all(np.array_equal(short.recording[key], long.recording[key]) for key in long.recording.columns)


def test_the_table_has_the_same_bytes_every_time(exo, tmp_path):
    for name in "ab":
        streamed_run.run(simulation(exo), tmp_path / "walk.rrd", tmp_path / f"{name}.parquet", most=100)
    assert (tmp_path / "a.parquet").read_bytes() == (tmp_path / "b.parquet").read_bytes()


def test_memory_does_not_grow_with_the_strides(exo):
    def peak(cycles):
        ready, summary = simulation(exo, cycles=cycles, scenario="level_walk"), Summary()
        tracemalloc.start()
        for piece in ready.pieces(most=100):
            summary.add(piece)
        used = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return used

    short = peak(7)
    assert peak(31) < 1.05 * short


def test_stopping_keeps_what_was_done(exo, tmp_path, monkeypatch):
    ready = simulation(exo)
    asked = iter([False] * 15 + [True] * 99)
    monkeypatch.setattr(streamed_run, "interrupts_noted", lambda: _given(lambda: next(asked)))
    numbers, interrupted = streamed_run.run(ready, tmp_path / "w.rrd", tmp_path / "w.parquet", most=100)
    assert interrupted and 3.0 < numbers["simulated_s"] < 4.5
    for ending in (".rrd", ".parquet"):
        assert len(read(tmp_path / f"w{ending}").recording.time) == round(numbers["simulated_s"] / ready.dt)


def test_an_interrupt_while_the_last_rows_are_written_is_not_swallowed(exo, tmp_path, monkeypatch):
    ready, rest = simulation(exo, cycles=2), streamed_run.Observer.rest

    def interrupted_meanwhile(self):
        signal.raise_signal(signal.SIGINT)
        return rest(self)

    monkeypatch.setattr(streamed_run.Observer, "rest", interrupted_meanwhile)
    _, interrupted = streamed_run.run(ready, tmp_path / "w.rrd", tmp_path / "w.parquet")
    assert interrupted
    assert len(read(tmp_path / "w.parquet").recording.time) == ready.rows


class _given:
    def __init__(self, value):
        self.value = value

    def __enter__(self):
        return self.value

    def __exit__(self, *rest):
        return None


def started(tmp_path, *options, until):
    """Start a run of thousands of strides; return it once a file of this pattern is there."""
    command = [sys.executable, "-m", "exo_sim", "run", "level_walk", "--assist", "vented", "--strides", "5000"]
    process = subprocess.Popen([*command, "--out", str(tmp_path / "walk.rrd"), *options], stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 500
    while process.poll() is None and time.monotonic() < deadline:
        if any(path.stat().st_size > 10_000_000 for path in tmp_path.glob(until)):
            break
        time.sleep(0.05)
    assert process.poll() is None, process.communicate()[1]
    return process


@pytest.mark.slow
def test_after_a_kill_what_was_simulated_is_there_and_reads(tmp_path):
    process = started(tmp_path, until="*.unfinished-*.rrd")
    process.kill()
    process.wait()
    (left,) = tmp_path.glob("*.unfinished-*.rrd")
    assert not (tmp_path / "walk.rrd").exists() and not (tmp_path / "walk.parquet").exists()
    left.write_bytes(left.read_bytes()[:-1000])  # in the middle of a message
    reading = read(left)
    assert reading.recording.duration > 5.0
    assert [finding.kind for finding in reading.findings if finding.severity == "warning"] == ["unfinished"]
    assert main(["inspect", str(left), "--quiet", "--out", str(tmp_path / "summary.txt")]) == 0


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_ends_with_130_and_both_files(tmp_path, number):
    process = started(tmp_path, until="*.unfinished-*.rrd")
    process.send_signal(number)
    assert process.wait(timeout=300) == 130
    assert "were simulated and are in" in process.stderr.read()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["walk.parquet", "walk.rrd"]
    assert read(tmp_path / "walk.parquet").recording.duration == pytest.approx(read(tmp_path / "walk.rrd").recording.duration)
