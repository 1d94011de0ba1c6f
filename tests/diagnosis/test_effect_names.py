"""What the diagnosis must know of an effect stands with the effect: its names are no part of the diagnosis."""

from __future__ import annotations

import ast
from pathlib import Path

import exo_sim.diagnosis
from exo_sim.diagnosis.findings import Kind
from exo_sim.physics.declaration import declared

ROOT = Path(exo_sim.diagnosis.__file__).parent
#: Files that are about one law, and so import what is declared of it: what they say of it is not what another effect could have.
ABOUT = {
    # errors of sensors: what a balance calls a zero, a gain or a delay, and a sensor that health or a sign found wrong
    "data/command_sign.py": {"sensor_scale"},
    "outcome/constant_force.py": {"asymmetric_friction", "coulomb_friction"},
    "outcome/rig_update.py": {"sensor_bias", "unknown"},
    "outcome/sensor_entries.py": {"sensor_bias", "sensor_delay", "sensor_scale"},
    "outcome/small_findings.py": {"sensor_bias"},
    "outcome/sensor_faults.py": {"sensor_bias", "sensor_scale"},
    "pipeline/reading.py": {"sensor_bias", "sensor_delay", "sensor_scale"},
    "pipeline/shared_supply.py": {"sensor_bias", "sensor_scale"},
    "selection/sensor_zero.py": {"sensor_bias"},
    "subsystems/gas/candidates.py": {"sensor_bias", "sensor_delay", "sensor_scale"},
    "subsystems/motion/indistinguishable.py": {"sensor_bias", "sensor_scale"},
    # what has no name
    "outcome/verdict.py": {"unknown"},
    "pipeline/rounds.py": {"unknown"},
    "selection/unknown_effect.py": {"unknown"},
    # the nozzle or the ellipse that stands for it; the curve of what is unknown
    "subsystems/gas/model.py": {"critical_ratio"},
    "subsystems/gas/unknown_curve.py": {"unknown"},
    # where the pressure sensor sits, when a command arrives, and what is too quick to be followed
    "subsystems/gas/arrived_commands.py": {"valve_lag"},
    "subsystems/gas/prediction.py": {"exhaust_back_pressure", "line_restriction", "valve_hysteresis", "valve_lag"},
    "subsystems/gas/hose_step.py": {"line_restriction", "valve_lag"},
    # the leak that every cylinder has
    "subsystems/healthy_leak.py": {"external_leakage"},
    # the contact that every seal has, in two forms
    "subsystems/motion/candidates.py": {"friction_smoothing", "presliding", "sensor_bias"},
    "pipeline/damped_contact.py": {"presliding"},
    "subsystems/motion/model.py": {"presliding"},
    # each law of resistance as columns of a linear problem
    "subsystems/motion/family.py": {"friction_smoothing", "presliding", "stribeck_friction"},
    "subsystems/motion/law_terms.py": {"coulomb_friction", "pressure_dependent_friction", "return_spring", "stribeck_friction"},
    "subsystems/motion/scales.py": {"coulomb_friction"},
    # a supply that gives way, stepped with the simulator's own functions
    "subsystems/supply/prediction.py": {"supply_droop", "supply_regulator"},
}  # fmt: skip


def _trees() -> dict[str, ast.Module]:
    return {str(path.relative_to(ROOT)): ast.parse(path.read_text(encoding="utf-8")) for path in sorted(ROOT.rglob("*.py"))}


def test_no_file_of_the_diagnosis_names_an_effect_in_a_string() -> None:
    names = set(declared())
    found = [
        (file, node.lineno, node.value)
        for file, tree in _trees().items()
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value in names
    ]
    assert [(file, name) for file, _, name in found] == [("findings.py", Kind.UNKNOWN.value)], found  # a kind of finding, no effect


def test_only_files_about_one_law_import_what_is_declared_of_it() -> None:
    found: dict[str, set[str]] = {}
    for file, tree in _trees().items():
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module == "exo_sim.physics.effects":
                found.setdefault(file, set()).update(one.name for one in node.names)
            elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("exo_sim.physics.effects."):
                found.setdefault(file, set()).add(str(node.module).rsplit(".", 1)[-1])
    more = {file: names - ABOUT.get(file, set()) for file, names in found.items() if names - ABOUT.get(file, set())}
    assert not more, f"declare it with the effect (exo_sim/physics/identification.py) and ask the declaration: {more}"
    gone = {file: names - found.get(file, set()) for file, names in ABOUT.items() if names - found.get(file, set())}
    assert not gone, f"these need not be known any more: take them from the list: {gone}"
