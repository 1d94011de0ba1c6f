"""Tests mirror the package: exo_sim/a/b.py is tested by tests/a/test_b.py, or is named here with the test that has it."""

from __future__ import annotations

from pathlib import Path

import pytest

#: By test, the modules of other names that it tries: numbers and sentences that hold nothing to be asked, parts of one law or one loop that
#: are tried as the whole that they make, and what only a whole run, page or trial shows. A new module has a test of its own.
ELSEWHERE: dict[str, tuple[str, ...]] = {
    "api/test_api.py": (
        "api/arguments.py", "api/comparing.py", "api/diagnosing.py", "api/doctor.py", "api/effects.py", "api/errors.py",
        "api/inspecting.py", "api/model_logging.py", "api/notebook.py", "api/picture.py", "api/plots.py", "api/recording.py",
        "api/rig.py", "api/simulating.py", "api/sizing.py", "cli/doctor.py",
    ),
    "cli/test_size.py": (
        "report/sizing_page.py", "report/sizing_picture.py", "sizing/by_hand.py", "sizing/summary_text.py",
    ),
    "control/test_demand.py": (
        "control/machine_dynamics.py",
    ),
    "conventions/test_conventions.py": (
        "conventions/check.py", "conventions/gas_balance.py", "conventions/machine.py", "conventions/positions.py",
        "conventions/pressures.py", "conventions/signs.py",
    ),
    "diagnosis/outcome/test_experiments.py": (
        "diagnosis/subsystems/motion/experiments.py",
    ),
    "diagnosis/pipeline/test_diagnose_benches.py": (
        "diagnosis/selection/remainder.py", "diagnosis/subsystems/gas/experiments.py",
    ),
    "diagnosis/pipeline/test_sorting.py": (
        "simulation/replay/external_drive.py",
    ),
    "diagnosis/policy/test_number.py": (
        "diagnosis/policy/budgets.py", "diagnosis/policy/calibration.py", "diagnosis/policy/gates.py", "diagnosis/policy/healthy.py",
        "diagnosis/policy/judgement.py", "diagnosis/policy/priors.py", "diagnosis/policy/recordings.py", "diagnosis/policy/regimes.py",
        "diagnosis/policy/validation.py",
    ),
    "diagnosis/selection/test_search.py": (
        "diagnosis/subsystem_model.py",
    ),
    "environments/test_environments.py": (
        "environments/dm.py", "environments/episode.py", "environments/gym.py",
    ),
    "gait/test_motion.py": (
        "gait/recorded.py", "gait/scenario.py", "gait/scenarios/level_walk.py", "gait/scenarios/level_walk_opensim.py",
        "gait/scenarios/payload_step.py", "gait/scenarios/sit_to_stand.py", "gait/scenarios/squat.py", "gait/scenarios/stand.py",
    ),
    "gait/test_own_gait.py": (
        "gait/contact_fit.py", "gait/files/c3d.py", "gait/files/opensim.py", "gait/files/table.py", "gait/labels.py",
        "gait/scenario_file.py", "gait/signs.py", "gait/standing.py", "gait/strides.py", "gait/trial.py", "gait/walking.py",
    ),
    "machine/test_anthropometry.py": (
        "machine/person.py",
    ),
    "machine/test_build.py": (
        "machine/linkage.py", "machine/metabolism.py",
    ),
    "machine/test_mjcf.py": (
        "machine/mujoco_words.py",
    ),
    "machine/test_straps.py": (
        "machine/wearer.py",
    ),
    "physics/effects/test_external_leakage.py": (
        "physics/conditions.py",
    ),
    "recording/test_hostile_tables.py": (
        "recording/csv_table.py",
    ),
    "recording/test_reader.py": (
        "recording/clock.py", "recording/parquet_table.py", "recording/selection.py",
    ),
    "recording/test_rrd_names.py": (
        "recording/blueprint.py",
    ),
    "recording/test_summary.py": (
        "cli/inspect.py", "recording/summary_text.py",
    ),
    "recording/test_writing.py": (
        "cli/view.py", "recording/rrd_file.py", "recording/rrd_messages.py", "recording/rrd_scene.py", "recording/rrd_sink.py",
        "recording/rrd_table.py", "recording/rrd_timeline.py", "recording/scene.py", "recording/viewer.py",
    ),
    "report/test_diagnosis_page.py": (
        "report/diagnosis_picture.py", "report/diagnosis_text.py", "report/diagnosis_words.py",
    ),
    "rig/test_reading.py": (
        "rig/effects.py",
    ),
    "simulation/replay/test_replay.py": (
        "simulation/replay/inputs.py", "simulation/replay/loop.py", "simulation/replay/machine.py",
    ),
    "simulation/test_buildable.py": (
        "simulation/coupled.py", "simulation/summary.py",
    ),
    "simulation/test_causal.py": (
        "control/causal.py",
    ),
    "simulation/test_coupled_step.py": (
        "simulation/bound_arrays.py", "simulation/native.py",
    ),
    "simulation/test_driven.py": (
        "assets/controllers/delayed_feedback.py", "assets/controllers/impedance.py", "assets/controllers/learnt_policy.py",
    ),
    "simulation/test_joint_effects.py": (
        "simulation/loop.py", "simulation/loop_wiring.py",
    ),
    "simulation/test_unworn.py": (
        "cli/run_motion.py", "simulation/unworn_record.py", "simulation/wanted_motion.py",
    ),
    "simulation/test_walk.py": (
        "control/least_load.py", "control/own_faults.py", "control/strap_feedback.py", "control/stride_learning.py",
        "control/tracking.py", "rig/schema.py", "simulation/calibration.py", "simulation/coupling.py", "simulation/ledger.py",
        "simulation/record.py", "simulation/reduction.py", "simulation/rehearsal.py", "simulation/views.py", "simulation/wearer_load.py",
    ),
    "sizing/test_coupled_stride.py": (
        "sizing/screening.py",
    ),
    "sizing/test_design.py": (
        "sizing/linkage_geometry.py", "sizing/study.py", "sizing/writing.py",
    ),
    "sizing/test_motion_search.py": (
        "sizing/motion_loads.py", "sizing/motion_result.py",
    ),
    "sizing/test_search.py": (
        "sizing/choice.py", "sizing/confirmation.py", "sizing/evaluation.py", "sizing/first_designs.py", "sizing/workers.py",
    ),
    "test_docs.py": (
        "rig/key_reference.py",
    ),
    "test_inputs.py": (
        "recording/column_map.py",
    ),
    "test_main.py": (
        "__main__.py",
    ),
    "trials/cantera/test_network.py": (
        "trials/cantera/case.py", "trials/whole/machine.py",
    ),
    "trials/real/test_balance.py": (
        "trials/real/case.py",
    ),
    "trials/real/test_judge.py": (
        "trials/real/errors.py",
    ),
    "trials/real/test_machines.py": (
        "trials/real/honest.py", "trials/real/runner.py",
    ),
    "trials/test_broken_trials.py": (
        "trials/cells.py", "trials/judge.py", "trials/ledger.py", "trials/score.py", "trials/seal.py", "trials/tool.py",
    ),
    "trials/test_cases.py": (
        "trials/effects.py", "trials/limit.py",
    ),
    "trials/test_protocol.py": (
        "cli/trial.py", "trials/develop.py", "trials/figures.py", "trials/page.py",
    ),
    "trials/test_rivals.py": (
        "trials/leg_cases.py",
    ),
    "trials/truth/test_leg.py": (
        "trials/leg_limit.py",
    ),
    "trials/truth/test_plant.py": (
        "trials/truth/bench.py", "trials/truth/drive.py", "trials/truth/excitation.py", "trials/truth/instruments.py",
        "trials/truth/machine.py",
    ),
    "trials/whole/test_case.py": (
        "trials/whole/__main__.py", "trials/whole/blocks.py", "trials/whole/compiled.py", "trials/whole/draw.py",
        "trials/whole/instruments.py", "trials/whole/makes.py", "trials/whole/mapping.py", "trials/whole/matters.py",
        "trials/whole/owner.py", "trials/whole/running.py",
    ),
    "trials/whole/test_judge.py": (
        "trials/whole/fresh.py", "trials/whole/runner.py", "trials/whole/table.py",
    ),
    "trials/whole/test_plant.py": (
        "trials/whole/catalogue.py", "trials/whole/excitation.py", "trials/whole/friction_laws.py", "trials/whole/gas_laws.py",
        "trials/whole/loop.py",
    ),
    "trials/whole/walk/test_case.py": (
        "trials/whole/walk/anatomy.py", "trials/whole/walk/gait.py", "trials/whole/walk/worn.py",
    ),
}  # fmt: skip
LISTED = [module for modules in ELSEWHERE.values() for module in modules]


def mirror(module: str) -> str:
    """Return the test of a module's own name."""
    path = Path(module)
    return str(path.parent / f"test_{path.name}")


def test_every_module_has_a_test(repository: Path) -> None:
    package = repository / "exo_sim"
    modules = {str(path.relative_to(package)) for path in package.rglob("*.py") if path.name != "__init__.py"}
    own = {module for module in modules if (repository / "tests" / mirror(module)).exists()}
    assert sorted(modules - own - set(LISTED)) == [], "write its test, or name the test that has it in tests/test_layout.py"
    assert len(LISTED) == len(set(LISTED))


@pytest.mark.parametrize("test", ELSEWHERE)
def test_what_is_named_is_there(repository: Path, test: str) -> None:
    assert (repository / "tests" / test).is_file()
