"""From an MJCF file to the model of a machine that fits its wearer and carries a payload."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from exo_sim.errors import ModelError, ScenarioError, nearest
from exo_sim.machine.fitting import fit, require, tell_moments
from exo_sim.machine.ground import LEVEL, Ground
from exo_sim.machine.person import Person
from exo_sim.rig.schema import Ankle, JointFactors, Rig

if TYPE_CHECKING:
    import mujoco

#: What the frame is built to carry [kg].
PAYLOAD_LIMIT = 45.0


def build(
    path: Path,
    person: Person,
    payload: float,
    ankle: Ankle,
    masses: Mapping[str, float] | None = None,
    joints: Mapping[str, JointFactors] | None = None,
    embodied: bool = False,
    ground: Ground = LEVEL,
    length: float = 0.0,
) -> mujoco.MjModel:
    """Read an MJCF of the kind of `assets/exo.xml` and fit it.

    Segments grow with body height; every attachment keeps its distance from the joint next to it, so that cylinders
    keep their stroke and moment arm. The payload's inertia grows with its mass.

    Args:
        path: The MJCF, drawn for a body height of `REFERENCE_HEIGHT`.
        person: Who wears it.
        payload: Mass on the back [kg], 0 to `PAYLOAD_LIMIT`.
        ankle: What the ankle does.
        masses: Of bodies that the rig knows better than the file [kg]; the payload's is `payload` all the same.
        joints: Factors on the file's numbers of joints, by joint.
        embodied: The wearer is there with mass, joints and soles (`wearer_body`), behind the machine; else only shown.
        ground: What is walked on, and the `length` of the walk [m].

    Raises:
        ModelError: the file cannot be read, lacks a joint or body that a worn machine needs, or is laid out otherwise.
        ScenarioError: a payload that the frame cannot carry.
    """
    import mujoco

    from exo_sim.machine import mjcf, wearer_body, worn_layout
    from exo_sim.machine.rig_model import corrected

    if not 0.0 <= payload <= PAYLOAD_LIMIT:
        raise ScenarioError(f"payload {payload:g} kg: the frame carries 0 to {PAYLOAD_LIMIT:g} kg")
    spec = mjcf.read_spec(path)
    require(spec, path)
    worn_layout.check(mjcf.compiled(spec.copy(), path), path)
    fit(spec, person, ankle)
    tell_moments(spec)
    load = spec.geom("payload")
    if payload > 0:
        load.mass = payload
    else:
        load.mass = 1e-6
        load.rgba[3] = 0.0
    if embodied:
        wearer_body.add(spec, person)
    ground.lay(spec, length)
    model = mjcf.compiled(spec, path)
    for name, mass in (masses or {}).items():
        if name == "payload":
            continue
        bodies = [model.body(i).name for i in range(model.nbody)]
        if name not in bodies or model.body_mass[bodies.index(name)] <= 0.0:
            raise ModelError(f"bodies.{name} is not a body with mass in {path}{nearest(name, bodies)}")
        index = bodies.index(name)
        model.body_inertia[index] *= mass / model.body_mass[index]
        model.body_mass[index] = mass
    if masses:
        mujoco.mj_setConst(model, mujoco.MjData(model))
    corrected(model, joints or {}, str(path))
    return model


def with_hung(rig: Rig, hung: Mapping[str, float]) -> dict[str, float]:
    """Return a rig's masses of bodies with some hung on them beside, by name [kg].

    Raises:
        ModelError: the MJCF cannot be read, or has no such body with mass.
    """
    from exo_sim.machine import mjcf

    masses = dict(rig.body_masses)
    if not hung:
        return masses
    model = mjcf.compiled(mjcf.read_spec(rig.model), rig.model)
    of = {model.body(i).name: float(model.body_mass[i]) for i in range(model.nbody) if model.body_mass[i] > 0.0}
    for name, mass in hung.items():
        if name not in of:
            raise ModelError(f"hung.{name} is not a body with mass in {rig.model}{nearest(name, of)}")
        masses[name] = masses.get(name, of[name]) + mass
    return masses


def is_worn(rig: Rig) -> bool:
    """Return whether a rig's machine carries a person: whether its MJCF has any of the joints that move a torso.

    Raises:
        ModelError: the MJCF cannot be read.
    """
    from exo_sim.machine import mjcf

    return any(joint.name in ("torso_x", "torso_z", "torso_pitch") for joint in mjcf.read_spec(rig.model).joints)


def carry(model: mujoco.MjModel, payload: float, body: int | None = None) -> None:
    """Set the mass on the back of a compiled model, inertia in proportion [kg]; also beyond `PAYLOAD_LIMIT`."""
    import mujoco

    body = int(model.geom("payload").bodyid[0]) if body is None else body
    mass = max(payload, 1e-6)
    model.body_inertia[body] *= mass / model.body_mass[body]
    model.body_mass[body] = mass
    mujoco.mj_setConst(model, mujoco.MjData(model))
