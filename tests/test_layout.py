"""Tests mirror the package: exo_sim/a/b.py is tested by tests/a/test_b.py, by a test that imports it, or through what is named here."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

#: By test, the modules that it tries without naming them: numbers and sentences that hold nothing to be asked, parts of one law or one loop
#: that are tried as the whole that they make, and what only a whole run, page or command shows. A new module has a test of its own.
THROUGH: dict[str, tuple[str, ...]] = {
    "api/test_api.py": (
        "api/comparing.py", "api/diagnosing.py", "api/doctor.py", "api/effects.py", "api/errors.py",
        "api/inspecting.py", "api/model_logging.py", "api/notebook.py", "api/recording.py",
        "api/rig.py", "api/simulated.py", "api/simulating.py", "api/sizing.py", "cli/doctor.py",
    ),
    "cli/test_size.py": (
        "report/sizing_page.py", "report/sizing_picture.py", "sizing/summary_text.py",
    ),
    "conventions/test_conventions.py": (
        "conventions/check.py", "conventions/gas_balance.py", "conventions/signs.py",
    ),
    "control/user_controller/test_running.py": (
        "control/user_controller/faults.py",
    ),
    "diagnosis/policy/test_number.py": (
        "diagnosis/policy/significance.py",
    ),
    "environments/test_environments.py": (
        "environments/dm.py", "environments/gym.py",
    ),
    "gait/test_motion.py": (
        "gait/scenarios/fast_walk.py", "gait/scenarios/level_walk.py", "gait/scenarios/level_walk_opensim.py",
        "gait/scenarios/payload_step.py", "gait/scenarios/sit_to_stand.py", "gait/scenarios/slope_down.py", "gait/scenarios/slope_up.py",
        "gait/scenarios/slow_walk.py", "gait/scenarios/squat.py", "gait/scenarios/stairs_down.py", "gait/scenarios/stairs_up.py",
        "gait/scenarios/stand.py", "gait/scenarios/start_and_stop.py", "gait/scenarios/uneven_load.py",
    ),
    "gait/test_own_gait.py": (
        "gait/files/c3d.py", "gait/files/opensim_motion.py",
        "gait/files/table.py", "gait/standing.py",
        "gait/walking_trial.py",
    ),
    "recording/test_hostile_tables.py": (
        "recording/csv_beginning.py", "recording/csv_table.py",
    ),
    "recording/test_reader.py": (
        "recording/parquet_table.py",
    ),
    "recording/test_summary.py": (
        "cli/inspect.py",
    ),
    "recording/test_writing.py": (
        "cli/view.py", "recording/rrd_messages.py", "recording/rrd_sink.py", "recording/rrd_table.py", "recording/rrd_timeline.py",
        "recording/viewer.py",
    ),
    "rig/test_reading.py": (
        "rig/effect_tables.py",
    ),
    "simulation/replay/test_replay.py": (
        "simulation/replay/loop.py", "simulation/replay/machine.py",
    ),
    "simulation/test_coupled_step.py": (
        "simulation/bound_arrays.py", "simulation/mujoco_calls.py",
    ),
    "simulation/test_external_commands.py": (
        "assets/controllers/delayed_feedback.py", "assets/controllers/impedance.py", "assets/controllers/learnt_policy.py",
    ),
    "simulation/test_linearised_walk.py": (
        "simulation/linearised_step.py",
    ),
    "simulation/test_plugin.py": (
        "simulation/snapshot.py",
    ),
    "simulation/test_unworn.py": (
        "cli/run_motion.py", "simulation/force_loops.py", "simulation/unworn_log.py", "simulation/wanted_motion.py",
    ),
    "simulation/test_torque_driven.py": (
        "simulation/torque_driven_wearer.py", "simulation/wearer_inverse_dynamics.py",
    ),
    "simulation/test_walk.py": (
        "control/load_weights.py", "control/strap_feedback.py",
        "simulation/causal_calibration.py", "simulation/coupled_step.py", "simulation/loop_log.py",
        "simulation/valve_loop.py", "simulation/views.py",
        "simulation/worn_demand.py", "simulation/worn_log.py",
    ),
    "sizing/test_search.py": (
        "sizing/confirmation.py", "sizing/first_designs.py",
    ),
    "test_main.py": (
        "__main__.py",
    ),
    "trials/test_protocol.py": (
        "cli/trial.py", "trials/develop.py",
    ),
    "trials/truth/test_plant.py": (
        "trials/compiled.py", "trials/truth/bench.py", "trials/truth/compiled.py", "trials/truth/loop.py",
    ),
    "trials/whole_machines/test_case.py": (
        "trials/whole_machines/compiled.py", "trials/whole_machines/effect_sizes.py", "trials/whole_machines/nearest_effects.py",
        "trials/whole_machines/owner_rig.py",
    ),
    "trials/whole_machines/test_plant.py": (
        "trials/whole_machines/hose.py",
    ),
}  # fmt: skip
LISTED = {module for modules in THROUGH.values() for module in modules}


def imported(tests: Path) -> set[str]:
    """Return the modules that any test imports, as files of the package."""
    found: set[str] = set()
    for path in tests.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                names = [one.name for one in node.names]
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                names = [node.module, *(f"{node.module}.{one.name}" for one in node.names)]
            else:
                continue
            found.update(f"{name.removeprefix('exo_sim.').replace('.', '/')}.py" for name in names if name.startswith("exo_sim."))
    return found


def test_every_module_has_a_test(repository: Path) -> None:
    package, tests = repository / "exo_sim", repository / "tests"
    modules = {path.relative_to(package) for path in package.rglob("*.py") if path.name != "__init__.py"}
    alone = {str(module) for module in modules if not (tests / module.parent / f"test_{module.name}").exists()}
    assert sorted(alone - imported(tests) - LISTED) == [], "write its test, or name the test that tries it in tests/test_layout.py"


@pytest.mark.parametrize("test", THROUGH)
def test_what_is_named_is_there(repository: Path, test: str) -> None:
    assert (repository / "tests" / test).is_file()
