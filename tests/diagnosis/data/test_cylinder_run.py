"""A part of a run: every channel is cut alike, stretches begin where they did; and what counts as rest."""

from __future__ import annotations

import math
from dataclasses import fields, replace
from pathlib import Path

import benches
import numpy as np
import pytest
from diagnosis import cylinder_runs
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.data.cylinder_run import cylinder_runs as runs_of
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load

N = 60
OTHERS = (
    "recording", "cylinder", "commanded", "noise", "breaks", "pressure", "initial", "position_noise", "settled", "sampled", "computed",
)  # fmt: skip
CHANNELS = [field.name for field in fields(CylinderRun) if field.name not in OTHERS]
SPANS = st.tuples(st.integers(0, N - 1), st.integers(1, N)).filter(lambda span: span[0] < span[1])


def full(breaks: tuple[int, ...] = (0,)) -> CylinderRun:
    """Return a run whose every channel tells the sample and the channel."""
    channels = {name: np.arange(N) + 1000.0 * k for k, name in enumerate(CHANNELS)}
    return cylinder_runs.run_of(np.arange(N) - 1000.0, np.arange(N) - 2000.0, noise=(1.0, 2.0), breaks=breaks, **channels)


def channels(run: CylinderRun) -> list[np.ndarray]:
    found = [getattr(run, name) for name in CHANNELS] + list(run.pressure)
    assert all(isinstance(one, np.ndarray) for one in found)
    return found


def same(one: CylinderRun, other: CylinderRun) -> bool:
    return one.breaks == other.breaks and all(np.array_equal(a, b) for a, b in zip(channels(one), channels(other), strict=True))


@given(span=SPANS)
def test_every_channel_is_cut_alike(span: tuple[int, int]) -> None:
    run = full()
    part = run.part(*span)
    for whole, cut in zip(channels(run), channels(part), strict=True):
        np.testing.assert_array_equal(cut, whole[slice(*span)])
    assert (part.recording, part.cylinder, part.noise, part.commanded) == (run.recording, run.cylinder, run.noise, run.commanded)
    assert len(run.time) == N


@given(span=SPANS)
def test_only_the_beginning_knows_the_first_pressure(span: tuple[int, int]) -> None:
    run = replace(full(), initial=(3e5, math.nan))
    first, second = run.part(*span).initial
    assert (first == 3e5) == (span[0] == 0) and math.isnan(second)


@given(span=SPANS, inner=st.sets(st.integers(1, N - 1), max_size=8))
def test_stretches_begin_at_the_same_samples(span: tuple[int, int], inner: set[int]) -> None:
    run = full((0, *sorted(inner)))
    part = run.part(*span)
    assert part.breaks[0] == 0 and list(part.breaks) == sorted(set(part.breaks))
    begun = set(run.time[list(run.breaks)]) | {run.time[span[0]]}
    assert set(part.time[list(part.breaks)]) == begun & set(part.time)


@given(span=SPANS, within=SPANS, inner=st.sets(st.integers(1, N - 1), max_size=8))
def test_a_part_of_a_part_is_a_part(span: tuple[int, int], within: tuple[int, int], inner: set[int]) -> None:
    run = full((0, *sorted(inner)))
    length = span[1] - span[0]
    start, stop = min(within[0], length - 1), min(within[1], length)
    assert same(run.part(*span).part(start, stop), run.part(span[0] + start, span[0] + stop))


@given(stop=st.integers(1, N), inner=st.sets(st.integers(1, N - 1), max_size=8))
def test_until_is_the_part_from_the_first_sample(stop: int, inner: set[int]) -> None:
    run = full((0, *sorted(inner)))
    assert same(run.until(stop), run.part(0, stop))
    assert same(run.until(N), run)


def test_what_was_not_recorded_stays_so() -> None:
    part = cylinder_runs.run_of(None, np.arange(9.0), length=None, speed=None).part(2, 5)
    assert part.length is part.speed is part.supply is part.exhaust is part.supply_temperature is part.force is part.pressure[0] is None
    np.testing.assert_array_equal(part.pressure[1], [2.0, 3.0, 4.0])


@pytest.mark.parametrize(
    ("command", "length", "rests"),
    [(0.0, 0.0, True), (0.0, 5e-5, True), (0.0, 2e-4, False), (0.01, 0.0, False), (0.0, None, True), (0.01, None, False)],
)
def test_it_rests_where_neither_valve_nor_piston_moves(command: float, length: float | None, rests: bool) -> None:
    swing = np.sin(np.linspace(0.0, 9.0, N))
    moved = None if length is None else 0.1 + length * swing / np.ptp(swing)
    held = 0.3 + 0.5 * command * swing  # a valve held open is at rest as well
    run = cylinder_runs.run_of(np.linspace(5e5, 4e5, N), command=held, length=moved)
    assert run.at_rest is rests
    assert run.part(10, 11).at_rest


@pytest.mark.parametrize(("command", "switched"), [
    (np.where(np.arange(N) % 10 < 5, 1.0, 0.0), True),
    (np.where(np.arange(N) % 10 < 5, 0.7, -0.7), True),
    (np.where(np.arange(N) % 10 < 5, 0.4, 0.0), False),
    (np.sin(np.arange(N)), False),
    (np.ones(N), False),
])  # fmt: skip
def test_a_valve_that_is_only_switched_over(command: np.ndarray, switched: bool) -> None:
    pressure = np.linspace(2e5, 3e5, N)
    assert cylinder_runs.run_of(pressure, command=command, commanded=True).is_switched is switched
    assert not cylinder_runs.run_of(pressure, command=command, commanded=False).is_switched


@pytest.mark.parametrize(
    ("command", "changes"),
    [(np.where(np.arange(60) % 20 < 9, 1.0, -1.0), True), (np.arange(60) % 20 < 9, False), (np.sin(np.arange(60) / 9.0), False)],
    ids=["thrown across", "on and off", "slowly across"],
)  # fmt: skip
def test_whether_a_command_switches_straight_from_one_side_to_the_other(command: np.ndarray, changes: bool) -> None:
    run = cylinder_runs.run_of(np.full(60, 3e5), command=command.astype(float), commanded=True)
    assert run.changes_sides is changes


@pytest.mark.parametrize(("size", "never"), [(1.0, True), (0.97, True), (0.6, False)])
def test_whether_a_valve_is_ever_held_partly_open(size: float, never: bool) -> None:
    pressure = np.full(60, 3e5)
    command = size * np.sign(np.sin(np.arange(60) / 5.0)) * (np.arange(60) % 20 > 4)
    assert cylinder_runs.run_of(pressure, command=command, commanded=True).is_never_partly_open is never
    assert not cylinder_runs.run_of(pressure, command=command, commanded=False).is_never_partly_open


@pytest.mark.parametrize(
    ("command", "commanded", "stays"), [(0.8, True, True), (0.8, False, False), (0.0, True, False), (-0.3, True, True)]
)
def test_a_valve_that_stays_open(command: float, commanded: bool, stays: bool) -> None:
    pressure = np.linspace(5e5, 4e5, N)
    assert cylinder_runs.run_of(pressure, command=np.full(N, command), commanded=commanded).stays_open is stays
    assert not cylinder_runs.run_of(pressure, command=np.linspace(0.2, command, N), commanded=commanded).stays_open


@pytest.mark.parametrize("most", [1.0, 1.2])
def test_a_command_is_cut_to_full_opening_and_is_the_column_itself_where_it_keeps_within(most: float, tmp_path: Path) -> None:
    rig = benches.bench(tmp_path)
    table = benches.led(rig, 0.1)
    command = most * np.sin(np.arange(len(table.time)) * 0.1)
    command[10] = most
    table = replace(table, columns={**table.columns, "piston.valve_command": command})
    model = load(rig)
    (run,) = runs_of(table, rig, model, linkages(rig, model))
    np.testing.assert_array_equal(run.command, np.clip(command, -1.0, 1.0))
    assert (run.command is command) == (most == 1.0)
