"""What the MJCF of a worn machine must hold, and how its segments and ankles are made to fit the wearer of the rig."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import ModelError, nearest
from exo_sim.machine.ground import STAIRS
from exo_sim.machine.person import COORDINATES, REFERENCE_HEIGHT, SEGMENTS, Person
from exo_sim.machine.straps import worn
from exo_sim.rig.schema import Ankle

#: Geoms that a worn machine has: payload, floor, links that grow with the wearer, soles.
_GEOMS = ("payload", "floor", *(f"{part}_{side}" for side in "lr" for part in ("thigh", "shank", "foot", "heel", "toe")))
#: MuJoCo's number of `reduce="netforce"` of a contact sensor.
_NET_FORCE = 3
#: The segment below each that grows with the wearer.
_BELOW = {f"{upper}_{side}": f"{lower}_{side}" for side in "lr" for upper, lower in (("thigh", "shank"), ("shank", "foot"))}
_JOINTS = ("torso_x", "torso_z", *COORDINATES[2:])


def missing_parts(spec: Any) -> dict[str, list[str]]:
    """Return what a worn machine needs and this MJCF lacks, by kind; lists that are empty where it is one."""
    present = [joint.name for joint in spec.joints]
    missing = {"joint": [name for name in _JOINTS if name not in present]}
    missing["body"] = [name for name in (*SEGMENTS, "payload", *(f"person_{segment}" for segment in SEGMENTS)) if spec.body(name) is None]
    missing["geom"] = [name for name in _GEOMS if spec.geom(name) is None]
    missing["site"] = [name for name in (*(strap.site for strap in worn()), "foot_l", "foot_r") if spec.site(name) is None]
    missing["contact sensor"] = [name for name in ("ground_l", "ground_r") if spec.sensor(name) is None]
    return missing


def require(spec: Any, path: Path) -> None:
    """Check that the parts of a worn machine are there.

    Raises:
        ModelError: which are not.
    """
    joints = _JOINTS
    present = [joint.name for joint in spec.joints]
    if not set(joints) & set(present):
        raise ModelError(
            f"{path}: carries no person: walking and sizing need a worn machine, with joints {joints[0]}, {joints[1]}, {joints[2]}"
            " and so on as in assets/exo.xml (docs/your_machine.md); `exo-sim run MOTION.csv --rig RIG` moves any machine along a recorded "
            "motion, `exo-sim size --motion MOTION.csv --rig RIG` sizes it; inspect, compare and diagnose take any"
        )
    missing = missing_parts(spec)
    said = "; ".join(f"a {kind} " + ", ".join(f'"{name}"' for name in names) for kind, names in missing.items() if names)
    if said:
        lacking = [name for names in missing.values() for name in names]
        close = nearest(lacking[0], [*present, *(body.name for body in spec.bodies), *(site.name for site in spec.sites)])
        hint = close if "mean" in close else ""
        raise ModelError(f"{path}: a worn machine needs {said}{hint} (docs/your_machine.md lists what one must contain)")
    if present != list(joints):
        raise ModelError(f"{path}: a worn machine has the joints {', '.join(joints)}, in this order and no others")


def tell_moments(spec: Any) -> None:
    """Let the ground's contact sensors tell the moment about the place of the force as well: heel and toe are not rubbed alike."""
    import mujoco

    for side in "lr":
        spec.sensor(f"ground_{side}").intprm[0] |= 1 << int(mujoco.mjtConDataField.mjCONDATA_TORQUE)


def ground_sensors(model: Any, path: Path) -> tuple[int, int]:
    """Return where the ground's wrench on the left and the right foot begins among the sensor data of a compiled model.

    There are force, moment about the place of the force, and that place, three numbers each.

    Raises:
        ModelError: `ground_l` or `ground_r` measures something else.
    """
    import mujoco

    field = mujoco.mjtConDataField
    data = sum(1 << int(one) for one in (field.mjCONDATA_FORCE, field.mjCONDATA_TORQUE, field.mjCONDATA_POS))
    # the floor, or the stairs that `ground.lay` put in its place
    grounds = [(int(mujoco.mjtObj.mjOBJ_GEOM), model.geom("floor").id)]
    stairs = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, STAIRS)
    grounds += [(int(mujoco.mjtObj.mjOBJ_BODY), stairs)] if stairs >= 0 else []
    found = []
    for side in "lr":
        sensor = model.sensor(f"ground_{side}")
        of = int(mujoco.mjtObj.mjOBJ_BODY), model.body(f"foot_{side}").id
        measured = int(sensor.type[0]), (int(sensor.objtype[0]), int(sensor.objid[0]))
        on = int(sensor.reftype[0]), int(sensor.refid[0])
        tells = list(model.sensor_intprm[sensor.id])
        if measured != (int(mujoco.mjtSensor.mjSENS_CONTACT), of) or on not in grounds or tells != [data, _NET_FORCE, 1]:
            raise ModelError(
                f'{path}: the sensor "ground_{side}" must be <contact name="ground_{side}" body1="foot_{side}" geom2="floor" num="1" '
                'reduce="netforce" data="force pos"/>'
            )
        found.append(int(sensor.adr[0]))
    return found[0], found[1]


def fit(spec: Any, person: Person, ankle: Ankle) -> None:
    """Give the segments of a worn machine the person's lengths, and its ankles their spring.

    Args:
        spec: The MJCF, drawn for a body height of `REFERENCE_HEIGHT`; changed.
        person: Who wears it.
        ankle: What the ankle does.
    """
    if person.height != REFERENCE_HEIGHT:
        _stretch(spec, person)
    for side in "lr":
        joint = spec.joint(f"ankle_{side}")
        joint.stiffness[0] = ankle.stiffness if ankle.mode == "sprung" else 0.0


def _lengthen(link: Any, longer: float) -> None:
    """Lengthen the geom of a link downwards, drawn from end to end or about its middle [m]; a mesh stays as it is."""
    import mujoco

    if np.isfinite(link.fromto[0]):
        link.fromto[5] -= longer
        return
    kind = mujoco.mjtGeom
    half = {kind.mjGEOM_BOX: 2, kind.mjGEOM_ELLIPSOID: 2, kind.mjGEOM_CAPSULE: 1, kind.mjGEOM_CYLINDER: 1}
    if link.type in half:
        link.size[half[link.type]] += longer / 2
        link.pos[2] -= longer / 2


def _spanning(spec: Any) -> list[tuple[Any, str, NDArray[np.float64]]]:
    """Return the sites of tendons that reach from a thigh or a shank to the segment below, that segment, and its z in the site's frame."""
    import mujoco

    model = spec.copy().compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    of_site = [_segment(model, int(body)) for body in model.site_bodyid]
    found = {}
    for tendon in range(model.ntendon):
        first = int(model.tendon_adr[tendon])
        wraps = range(first, first + int(model.tendon_num[tendon]))
        sites = [int(model.wrap_objid[i]) for i in wraps if model.wrap_type[i] == mujoco.mjtWrap.mjWRAP_SITE]
        reached = {of_site[site] for site in sites}
        for site in sites:
            below = _BELOW.get(of_site[site])
            if below in reached:
                segment = model.body(of_site[site]).id
                frame = data.xmat[model.site_bodyid[site]].reshape(3, 3)
                found[site] = (spec.sites[site], of_site[site][:-2], frame.T @ data.xmat[segment].reshape(3, 3)[:, 2])
    return list(found.values())


def _segment(model: Any, body: int) -> str:
    """Return the segment that a body of a compiled model is fixed to; the world's name where it is none of them."""
    while body and model.body(body).name not in SEGMENTS:
        body = int(model.body_parentid[body])
    return str(model.body(body).name)


def _stretch(spec: Any, person: Person) -> None:
    """Lengthen (or shorten) the segments from the reference height to the person's."""
    reference = Person(REFERENCE_HEIGHT, person.mass)
    leg = person.thigh + person.shank + person.ankle_height
    for prefix in ("", "person_"):
        torso = spec.body(f"{prefix}torso")
        torso.pos = [torso.pos[0], torso.pos[1], leg]
    spec.joint("torso_z").ref = leg
    for key in spec.keys:
        if len(key.qpos):
            key.qpos[1] = leg
    change = {"thigh": person.thigh - reference.thigh, "shank": person.shank - reference.shank}
    for site, segment, down in _spanning(spec):  # on the segment above a joint that the cylinder moves: next to that joint
        site.pos = site.pos - change[segment] * down
    for side in "lr":
        shank, foot = spec.body(f"shank_{side}"), spec.body(f"foot_{side}")
        shank.pos = [shank.pos[0], shank.pos[1], shank.pos[2] - change["thigh"]]
        foot.pos = [foot.pos[0], foot.pos[1], foot.pos[2] - change["shank"]]
        for segment, longer in change.items():
            _lengthen(spec.geom(f"{segment}_{side}"), longer)
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
