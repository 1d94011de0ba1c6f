"""From an MJCF file to a compiled model, or one line that says why not: also of numbers that MuJoCo takes and no machine has."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import ModelError, one_line
from exo_sim.machine import mujoco_warnings  # noqa: F401 - its warnings are ours from here on
from exo_sim.machine.named_files import check_named

#: Time steps between which a machine can be simulated [s].
SHORTEST_STEP, LONGEST_STEP = 1e-7, 0.01
#: More than this is no number of a machine: kg, N m s, N/m ... .
LARGEST = 1e9


def read_spec(path: Path) -> mujoco.MjSpec:
    """Return an MJCF as an editable specification.

    Raises:
        ModelError: it or a file that it names is no file, MuJoCo refuses it, or a name in it is no text.
    """
    try:
        check_named(path)
        spec = mujoco.MjSpec.from_file(str(path))
    except FileNotFoundError:
        raise ModelError(f'{path}: no such file; "model" in the rig names the MJCF relative to the rig file') from None
    except (OSError, ValueError, RuntimeError, mujoco.FatalError) as error:
        raise ModelError(f"{path}: MuJoCo cannot read it: {one_line(str(error))}") from None
    for element in itertools.chain(spec.bodies, spec.joints, spec.geoms, spec.sites, spec.tendons, spec.actuators, spec.sensors):
        with _names_as_text(path):
            _ = element.name
    return spec


def compiled(spec: mujoco.MjSpec, path: Path) -> mujoco.MjModel:
    """Compile a specification.

    Raises:
        ModelError: MuJoCo refuses it, or it holds numbers that no machine has.
    """
    try:
        model = spec.compile()
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        raise ModelError(f"{path}: MuJoCo cannot compile it: {one_line(str(error))}") from None
    check(model, path)
    return model


def check(model: mujoco.MjModel, path: Path, corrected: Collection[str] = ()) -> None:
    """Refuse numbers that MuJoCo takes and no machine has.

    Args:
        model: Compiled.
        path: Its file, for the error.
        corrected: Joints whose inertia a rig multiplies: a factor below 1 is a negative armature.

    Raises:
        ModelError: a time step that cannot be, a mass without end, negative damping, actuators switched off, a name that is no text.
    """
    with _names_as_text(path):
        model.names.decode()
    step = float(model.opt.timestep)
    if not SHORTEST_STEP <= step <= LONGEST_STEP:
        raise ModelError(
            f'{path}: timestep = "{step:g}": a machine with compressed gas in it is simulated in steps of {SHORTEST_STEP:g} to '
            f'{LONGEST_STEP:g} s; write <option timestep="0.001"/>'
        )
    if model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_ACTUATION):
        raise ModelError(f'{path}: <flag actuation="disable"/>: no cylinder could move anything; take it out')
    if not np.isfinite(model.opt.gravity).all() or np.abs(model.opt.gravity).max() > LARGEST:
        raise ModelError(f"{path}: gravity = {model.opt.gravity}: must be finite, in m/s^2")
    for kind, attribute, values, names in _numbers(model):
        least = np.array([-LARGEST if attribute == "armature" and name in corrected else 0.0 for name in names])
        wrong = ~(np.isfinite(values) & (values >= least) & (values < LARGEST))
        if wrong.any():
            at = int(np.argmax(wrong))
            raise ModelError(
                f'{path}: {kind} "{names[at]}": {attribute} = {values[at]:g}: must be a number from 0 to {LARGEST:g}'
            )


@contextmanager
def _names_as_text(path: Path) -> Iterator[None]:
    """Raise a `ModelError` where MuJoCo hands on a name whose bytes are no text."""
    try:
        yield
    except UnicodeDecodeError as error:
        raise ModelError(f"{path}: the name {error.object[:40]!r} is not UTF-8 text; save the file as UTF-8") from None


def _numbers(model: mujoco.MjModel) -> Iterator[tuple[str, str, NDArray[np.float64], list[str]]]:
    bodies = [model.body(i).name or f"number {i}" for i in range(model.nbody)]
    joints = [model.joint(i).name or f"number {i}" for i in range(model.njnt)]
    of_dofs = [joints[int(j)] for j in model.dof_jntid]
    tendons = [model.tendon(i).name or f"number {i}" for i in range(model.ntendon)]
    yield "body", "mass", model.body_mass, bodies
    yield "body", "inertia", model.body_inertia.max(axis=1), bodies
    yield "joint", "damping", _flat(model.dof_damping), of_dofs
    yield "joint", "armature", model.dof_armature, of_dofs
    yield "joint", "frictionloss", model.dof_frictionloss, of_dofs
    yield "joint", "stiffness", _flat(model.jnt_stiffness), joints
    yield "tendon", "damping", _flat(model.tendon_damping), tendons
    yield "tendon", "frictionloss", model.tendon_frictionloss, tendons
    yield "tendon", "stiffness", _flat(model.tendon_stiffness), tendons


def _flat(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return one number a row: the linear one, where there are more."""
    return values if values.ndim == 1 else values[:, 0]
