"""From a rig to its MuJoCo model: the MJCF as it stands, with the masses, joint numbers and attachment points that the rig knows better."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from exo_sim.errors import ModelError, nearest
from exo_sim.machine import fitting, mjcf
from exo_sim.machine.attachment import attach
from exo_sim.machine.person import Person
from exo_sim.physics.declaration import declared
from exo_sim.rig import JointFactors, Rig
from exo_sim.rig.assembly import joints_with_effects


def spec(rig: Rig) -> mujoco.MjSpec:
    """Return the rig's MJCF as an editable specification, masses of `[bodies.NAME]` put in.

    Raises:
        ModelError: MuJoCo refuses the file, or a body is not in it.
    """
    loaded = mjcf.read_spec(rig.model)
    if rig.body_masses:
        before = compiled(loaded, rig)
        for name, mass in rig.body_masses.items():
            body = loaded.body(name)
            if body is None:
                names = [other.name for other in loaded.bodies]
                raise ModelError(f"{rig.path}: bodies.{name} is not a body of {rig.model.name}{nearest(name, names)}")
            index = before.body(name).id
            old = float(before.body_mass[index])
            if old <= 0.0:
                raise ModelError(f"{rig.path}: bodies.{name}: the body has no mass in {rig.model.name}; give its geom one")
            body.explicitinertial = True
            body.mass = mass
            body.ipos = before.body_ipos[index]
            body.iquat = before.body_iquat[index]
            body.inertia = before.body_inertia[index] * mass / old
    return loaded


def compiled(loaded: mujoco.MjSpec, rig: Rig) -> mujoco.MjModel:
    """Compile a specification.

    Raises:
        ModelError: MuJoCo refuses it, or it holds numbers that no machine has.
    """
    return mjcf.compiled(loaded, rig.model)


def corrected(model: mujoco.MjModel, joints: Mapping[str, JointFactors], source: str) -> None:
    """Multiply what a model says of its joints, and set stops inside its own.

    What a joint accelerates is changed by an armature: it moves nothing's centre of mass, so that gravity stays.

    Args:
        model: Changed.
        joints: Factors, by joint.
        source: What names the joints, for the error.

    Raises:
        ModelError: a joint that is not in the model, or stops outside those that it has.
    """
    names = [model.joint(i).name for i in range(model.njnt)]
    for name, factors in joints.items():
        if name not in names:
            raise ModelError(f"{source}: joints.{name} is not a joint of the model{nearest(name, names)}")
        dofs = model.joint(name).dofadr
        model.dof_damping[dofs] *= factors.damping
        model.dof_armature[dofs] += (factors.inertia - 1.0) * model.dof_M0[dofs]
        if factors.range is not None:
            _stop(model, name, factors.range, source)
    if joints:
        mujoco.mj_setConst(model, mujoco.MjData(model))


def _stop(model: mujoco.MjModel, name: str, ends: tuple[float, float], source: str) -> None:
    """Set the stops of a joint inside those that it has."""
    joint = model.joint(name).id
    low, high = model.jnt_range[joint] if model.jnt_limited[joint] else (-np.inf, np.inf)
    slack = 1e-6
    if int(model.jnt_type[joint]) not in (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)):
        raise ModelError(f"{source}: joints.{name}.range: a joint that neither turns nor slides has no stops")
    if ends[0] < low - slack or ends[1] > high + slack:
        raise ModelError(f"{source}: joints.{name}.range = {ends[0]:g} to {ends[1]:g} goes beyond the MJCF's own {low:g} to {high:g}")
    model.jnt_range[joint] = ends
    model.jnt_limited[joint] = True


def check_places(rig: Rig, model: mujoco.MjModel) -> None:
    """Refuse an effect on a joint that the model lacks.

    Raises:
        ModelError: the line proposes joints, and cylinders where the effect can act on one.
    """
    joints = [model.joint(i).name for i in range(model.njnt)]
    of_joints = joints_with_effects(rig)
    for effect in rig.effects:
        if effect.where in of_joints and effect.where not in joints:
            cylinders = rig.cylinders if "cylinder" in declared()[effect.name].places else ()
            offered = nearest(effect.where, {*joints, *cylinders})
            raise ModelError(f'{rig.path}: [effects.{effect.name}.{effect.where}]: {rig.model.name} has no joint "{effect.where}"{offered}')


def check_effects(rig: Rig, model: mujoco.MjModel) -> None:
    """Refuse an effect on a joint that the model lacks, one on a hinge in the units of a slide, or the reverse.

    Raises:
        ModelError: as `check_places`; 1 N where 1 N m must stand.
    """
    check_places(rig, model)
    kinds = {int(mujoco.mjtJoint.mjJNT_HINGE): True, int(mujoco.mjtJoint.mjJNT_SLIDE): False}
    turns = {model.joint(i).name: kinds.get(int(model.jnt_type[i])) for i in range(model.njnt)}
    for effect in rig.effects:
        turning = None if effect.where in rig.cylinders else turns.get(effect.where)
        if turning is None or turning == effect.turning:
            continue
        for parameter in declared()[effect.name].parameters:
            choice = int(effect.parameters.get(parameter.unit_by[0], 0.0)) if parameter.unit_by else 0
            given, wanted = (parameter.unit_at(turned, choice) for turned in (not turning, turning))
            if given != wanted and (parameter.name in effect.parameters or parameter.name in effect.curves):
                raise ModelError(
                    f'{rig.path}: effects.{effect.name}.{effect.where}.{parameter.name}: joint "{effect.where}" of '
                    f'{rig.model.name} {"turns" if turning else "slides"}: give it like "1 {wanted}"'
                )


def load(rig: Rig) -> mujoco.MjModel:
    """Return the rig's compiled model; that of a worn machine fits the rig's wearer and has the rig's ankles, as where it walks.

    Raises:
        ModelError: as `spec`, `compiled` and `check_effects`.
    """
    loaded = spec(rig)
    if not any(fitting.missing_parts(loaded).values()):
        fitting.fit(loaded, Person(rig.wearer.height, rig.wearer.mass), rig.ankle)
    model = compiled(loaded, rig)
    corrected(model, rig.joint_factors, str(rig.path))
    check_effects(rig, model)
    attach(model, rig)
    return model

