"""The wearer as bodies of a MuJoCo model: segments with mass on joints, soles that touch the ground.

The chain is that of `person.py`: a root with two slides and a pitch, hip, knee and ankle of each leg; and toes, which bend at the ball of
the foot. Masses are Winter's (`anthropometry.py`). Each sole touches with four spheres: rear and front of the heel's pad, ball and tip of
the toes, so that the centre of pressure is between those that touch. What gives under them is known (`sole_contact.py`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.machine import sole_contact
from exo_sim.machine.anthropometry import body as segments_of
from exo_sim.machine.ground_reaction import TOES
from exo_sim.machine.person import COORDINATES, SEGMENTS, Person
from exo_sim.machine.sole_contact import FRICTION, PAD, RADIUS

if TYPE_CHECKING:
    import mujoco

#: Joints of the wearer in the model, in the order of `COORDINATES` and, behind them, both toes.
JOINTS = (*(f"wearer_{name.removeprefix('pelvis_').removeprefix('torso_')}" for name in COORDINATES), "wearer_toe_l", "wearer_toe_r")
#: What touches the ground under each foot, from the rear, and its share of the stiffness there.
POINTS = {"heel": sole_contact.PAD_SHARE, "pad": sole_contact.PAD_SHARE, "ball": 1.0, "tip": 1.0}
#: Bending stiffness [N m/rad] of the toes (Sasaki, Neptune and Kautz 2009, Journal of Experimental Biology 212:738; the same in Falisse,
#: Afschrift and De Groote 2022, PLoS ONE 17:e0256311), damping [N m s/rad], and what their joint adds to their inertia [kg m^2].
TOE_STIFFNESS, TOE_DAMPING, TOE_ARMATURE = 25.0, 0.1, 1e-3
#: Share of the foot's mass in front of the ball.
_TOE_SHARE = 0.10
#: Of a contact sensor: what it tells, and that it sums up all contacts.
_FORCE_AND_PLACE, _NET_FORCE = 1 << 1 | 1 << 4, 3
#: Coordinates with an axis that is not -y.
_SLIDES = {"wearer_x": (1.0, 0.0, 0.0), "wearer_z": (0.0, 0.0, 1.0)}


@dataclass(frozen=True)
class WearerInModel:
    """Where the wearer is in a compiled model.

    Attributes:
        dofs: Degrees of freedom of `JOINTS`; positions have the same places, shape (11,).
        geoms: Of `POINTS`, left and right, shape (2, 4).
        ground: Where the data of the contact sensors begin, left and right: force and place, six numbers, shape (2,).
    """

    dofs: NDArray[np.int64]
    geoms: NDArray[np.int64]
    ground: NDArray[np.int64]


@dataclass(frozen=True)
class Pack:
    """A payload on the wearer's own back: mass [kg], centre from the hips, x and z [m], inertia a kilogram [m^2]."""

    mass: float
    place: tuple[float, float]
    inertia: float


def add(spec: mujoco.MjSpec, person: Person) -> None:
    """Put the wearer's bodies into a specification, in place of those that are only shown (`person_*`)."""
    import mujoco

    it = segments_of(person)
    shown = {name: _shapes(spec.body(f"person_{name}")) for name in SEGMENTS}
    aside = {name: _aside(spec.body(f"person_{name}")) for name in SEGMENTS}
    for name in SEGMENTS:
        if (old := spec.body(f"person_{name}")) is not None:
            spec.delete(old)
    leg = person.thigh + person.shank + person.ankle_height
    above: dict[str, Any] = {"torso": spec.worldbody}
    start = {"torso": leg, "thigh": 0.0, "shank": -person.thigh, "foot": -person.shank}
    for i, name in enumerate(SEGMENTS):
        part, _, side = name.partition("_")
        parent = above["torso"] if part == "torso" else above["thigh_root" if part == "thigh" else side]
        y = aside[name] - (0.0 if part in ("torso",) else aside["torso"] if part == "thigh" else aside[f"thigh_{side}"])
        new = parent.add_body(name=f"person_{name}", pos=[0.0, y, start[part]])
        if part == "torso":
            above["thigh_root"] = new
            for joint in JOINTS[:3]:
                axis = _SLIDES.get(joint, (0.0, -1.0, 0.0))
                kind = mujoco.mjtJoint.mjJNT_SLIDE if joint in _SLIDES else mujoco.mjtJoint.mjJNT_HINGE
                new.add_joint(name=joint, type=kind, axis=axis, ref=leg if joint == "wearer_z" else 0.0)
        else:
            above[side] = new
            joint = {"thigh": "hip", "shank": "knee", "foot": "ankle"}[part]
            new.add_joint(name=f"wearer_{joint}_{side}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=(0.0, -1.0, 0.0))
        mass, centre, inertia = float(it.mass[i]), it.centre[i], float(it.inertia[i])
        if part == "foot":
            mass, centre, inertia = _add_toes(new, side, mass, centre, inertia, person)
        _massive(new, mass, centre, inertia)
        for shape in shown[name]:
            new.add_geom(**shape)
    for side in "lr":
        spec.add_sensor(
            name=f"wearer_ground_{side}", type=mujoco.mjtSensor.mjSENS_CONTACT, objtype=mujoco.mjtObj.mjOBJ_XBODY,
            objname=f"person_foot_{side}", reftype=mujoco.mjtObj.mjOBJ_GEOM, refname="floor", intprm=[_FORCE_AND_PLACE, _NET_FORCE, 1],
        )  # fmt: skip


def _add_toes(foot: Any, side: str, mass: float, centre: NDArray[np.float64], inertia: float, person: Person) -> tuple[Any, ...]:
    """Hang toes on a foot with what touches the ground; return mass, centre and inertia that are left to the foot."""
    import mujoco

    touches = dict(
        type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[RADIUS, 0.0, 0.0], mass=0.0, contype=1, conaffinity=0, condim=3, priority=1,
        friction=[FRICTION, 0.005, 0.0001], solimp=sole_contact.solimp(), group=2, rgba=[0.85, 0.68, 0.56, 0.55],
    )  # fmt: skip
    low = -person.ankle_height + RADIUS
    for point, ahead in (("heel", person.heel), ("pad", person.heel + PAD * person.scale), ("ball", person.toe)):
        foot.add_geom(name=f"wearer_{point}_{side}", pos=[ahead, 0.0, low], **touches)
    length = TOES * person.scale
    toes = foot.add_body(name=f"person_toes_{side}", pos=[person.toe, 0.0, low])
    toes.add_joint(
        name=f"wearer_toe_{side}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=(0.0, -1.0, 0.0), armature=TOE_ARMATURE,
        stiffness=TOE_STIFFNESS, damping=TOE_DAMPING,
    )  # fmt: skip
    toes.add_geom(name=f"wearer_tip_{side}", pos=[length, 0.0, 0.0], **touches)
    share = _TOE_SHARE * mass
    own = share * length**2 / 12.0
    _massive(toes, share, np.array([0.5 * length, 0.0]), own)
    place = np.array([person.toe + 0.5 * length, low])
    rest = mass - share
    middle = (mass * centre - share * place) / rest
    left = inertia - own - share * ((place - centre) ** 2).sum() - rest * ((middle - centre) ** 2).sum()
    return rest, middle, float(left)


def _massive(body: Any, mass: float, centre: NDArray[np.float64], inertia: float) -> None:
    body.explicitinertial = True
    body.mass, body.ipos, body.inertia = mass, [centre[0], 0.0, centre[1]], [inertia, inertia, inertia]


def _shapes(body: Any) -> list[dict[str, Any]]:
    """Return what draws a body that is only shown."""
    if body is None:
        return []
    return [
        {"type": geom.type, "size": geom.size, "pos": geom.pos, "quat": geom.quat, "fromto": geom.fromto, "rgba": geom.rgba,
         "group": geom.group, "contype": 0, "conaffinity": 0, "mass": 0.0}
        for geom in body.geoms
    ]  # fmt: skip


def _aside(body: Any) -> float:
    return 0.0 if body is None else float(body.pos[1])


def find(model: mujoco.MjModel) -> WearerInModel:
    """Return where the wearer is in a model that `add` made, and give what touches its stiffness."""
    dofs = np.array([model.joint(name).dofadr[0] for name in JOINTS], dtype=np.int64)
    geoms = np.array([[model.geom(f"wearer_{point}_{side}").id for point in POINTS] for side in "lr"])
    for geom, share in zip(geoms.T, POINTS.values()):
        yields = model.body_invweight0[model.geom_bodyid[geom], 0]
        model.geom_solref[geom] = [sole_contact.solref(float(each), share) for each in yields]
    ground = np.array([model.sensor(f"wearer_ground_{side}").adr[0] for side in "lr"], dtype=np.int64)
    return WearerInModel(dofs, geoms, ground)


def alone(person: Person, pack: Pack | None = None, step: float = 0.001) -> mujoco.MjModel:
    """Return a model of the wearer on the ground, without a machine, with or without a payload on the back; steps in [s]."""
    import mujoco

    spec = mujoco.MjSpec()
    spec.option.timestep, spec.option.integrator = step, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone, spec.option.iterations, spec.option.ls_iterations = mujoco.mjtCone.mjCONE_ELLIPTIC, 20, 10
    floor = spec.worldbody.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 0.1])
    floor.contype, floor.conaffinity = 0, 1
    add(spec, person)
    if pack is not None and pack.mass > 0.0:
        on_back = spec.body("person_torso").add_body(name="pack", pos=[pack.place[0], 0.0, pack.place[1]])
        _massive(on_back, pack.mass, np.zeros(2), pack.mass * pack.inertia)
    return spec.compile()
