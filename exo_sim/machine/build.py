"""From an MJCF file to the model of a machine that fits its wearer and carries a payload."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from exo_sim.errors import ModelError, ScenarioError, nearest
from exo_sim.machine.person import COORDINATES, REFERENCE_HEIGHT, SEGMENTS, Person
from exo_sim.machine.straps import worn
from exo_sim.rig.schema import Ankle, JointFactors, Rig

if TYPE_CHECKING:
    import mujoco

#: Geoms that a worn machine has: payload, floor, links that grow with the wearer, soles.
_GEOMS = ("payload", "floor", *(f"{part}_{side}" for side in "lr" for part in ("thigh", "shank", "foot", "heel", "toe")))
#: What the frame is built to carry [kg].
PAYLOAD_LIMIT = 45.0


def build(
    path: Path,
    person: Person,
    payload: float,
    ankle: Ankle,
    masses: Mapping[str, float] | None = None,
    joints: Mapping[str, JointFactors] | None = None,
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

    Raises:
        ModelError: the file cannot be read, or lacks a joint or body that a worn machine needs.
        ScenarioError: a payload that the frame cannot carry.
    """
    import mujoco

    from exo_sim.machine import mjcf
    from exo_sim.machine.load import corrected

    if not 0.0 <= payload <= PAYLOAD_LIMIT:
        raise ScenarioError(f"payload {payload:g} kg: the frame carries 0 to {PAYLOAD_LIMIT:g} kg")
    spec = mjcf.read_spec(path)
    _require(spec, path)
    if person.height != REFERENCE_HEIGHT:
        _stretch(spec, person)
    load = spec.geom("payload")
    if payload > 0:
        load.mass = payload
    else:
        load.mass = 1e-6
        load.rgba[3] = 0.0
    for side in "lr":
        joint = spec.joint(f"ankle_{side}")
        joint.stiffness[0] = ankle.stiffness if ankle.mode == "sprung" else 0.0
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


def _require(spec: Any, path: Path) -> None:
    """Check that the parts of a worn machine are there."""
    joints = ("torso_x", "torso_z", *COORDINATES[2:])
    present = [joint.name for joint in spec.joints]
    if not set(joints) & set(present):
        raise ModelError(
            f"{path}: carries no person: walking and sizing need a worn machine, with joints {joints[0]}, {joints[1]}, {joints[2]}"
            " and so on as in assets/exo.xml (docs/your_machine.md); `exo-sim run MOTION.csv --rig RIG` moves any machine along a recorded "
            "motion; inspect, compare and diagnose take any"
        )
    missing = {"joint": [name for name in joints if name not in present]}
    missing["body"] = [name for name in (*SEGMENTS, *(f"person_{segment}" for segment in SEGMENTS)) if spec.body(name) is None]
    missing["geom"] = [name for name in _GEOMS if spec.geom(name) is None]
    missing["site"] = [name for name in (*(strap.site for strap in worn()), "foot_l", "foot_r") if spec.site(name) is None]
    missing["contact sensor"] = [name for name in ("ground_l", "ground_r") if spec.sensor(name) is None]
    said = "; ".join(f"a {kind} " + ", ".join(f'"{name}"' for name in names) for kind, names in missing.items() if names)
    if said:
        lacking = [name for names in missing.values() for name in names]
        close = nearest(lacking[0], [*present, *(body.name for body in spec.bodies), *(site.name for site in spec.sites)])
        hint = close if "mean" in close else ""
        raise ModelError(f"{path}: a worn machine needs {said}{hint} (docs/your_machine.md lists what one must contain)")
    if present != list(joints):
        raise ModelError(f"{path}: a worn machine has the joints {', '.join(joints)}, in this order and no others")


def _stretch(spec: Any, person: Person) -> None:
    """Lengthen (or shorten) the segments from the reference height to the person's."""
    reference = Person(REFERENCE_HEIGHT, person.mass)
    leg = person.thigh + person.shank + person.ankle_height
    for prefix in ("", "person_"):
        torso = spec.body(f"{prefix}torso")
        torso.pos = [torso.pos[0], torso.pos[1], leg]
    spec.joint("torso_z").ref = leg
    for key in spec.keys:
        key.qpos[1] = leg
    change = {"thigh": person.thigh - reference.thigh, "shank": person.shank - reference.shank}
    for side in "lr":
        shank, foot = spec.body(f"shank_{side}"), spec.body(f"foot_{side}")
        shank.pos = [shank.pos[0], shank.pos[1], shank.pos[2] - change["thigh"]]
        foot.pos = [foot.pos[0], foot.pos[1], foot.pos[2] - change["shank"]]
        spec.geom(f"thigh_{side}").fromto[5] -= change["thigh"]
        spec.geom(f"shank_{side}").fromto[5] -= change["shank"]
        base = spec.site(f"knee_{side}_base")  # next to the knee, though on the thigh
        base.pos = [base.pos[0], base.pos[1], base.pos[2] - change["thigh"]]
        for part in (*foot.geoms, *foot.sites):
            grown = [part.pos[0] * person.scale, part.pos[1], part.pos[2]]
            if part.name.startswith(("heel", "toe", "foot")):
                grown[2] -= person.ankle_height - reference.ankle_height
            part.pos = grown
        sole = spec.geom(f"foot_{side}")
        sole.size = [sole.size[0] * person.scale, sole.size[1], sole.size[2]]
    for segment in SEGMENTS:
        for geom in spec.body(f"person_{segment}").geoms:
            geom.fromto = [value * person.scale for value in geom.fromto]
            geom.pos = [value * person.scale for value in geom.pos]
