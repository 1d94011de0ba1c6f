"""What to draw in space: bodies made of simple shapes, cylinders that extend, arrows for forces. Plain arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rgba = tuple[float, float, float, float]
Kind = Literal["sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh"]

#: MuJoCo's numbers of geom types (mjtGeom) that are drawn.
_KINDS: dict[int, Kind] = {2: "sphere", 3: "capsule", 4: "ellipsoid", 5: "cylinder", 6: "box", 7: "mesh"}


@dataclass(frozen=True)
class Shape:
    """A shape that is fixed to a body.

    Attributes:
        name: Its name, one of its kind on its body.
        body: Index of its body in `Scene.bodies`.
        kind: What it is.
        size: As MuJoCo has it: radius; radius and half length; three half axes. Metres, shape (3,).
        position: In the body's frame, metres, shape (3,).
        quaternion: In the body's frame, w first, shape (4,).
        rgba: Each 0 to 1.
        vertices: Of a mesh, in the shape's frame, metres, shape (n, 3).
        faces: Of a mesh: indices of the corners of its triangles, shape (m, 3).
    """

    name: str
    body: int
    kind: Kind
    size: Array
    position: Array
    quaternion: Array
    rgba: Rgba = (0.6, 0.6, 0.6, 1.0)
    vertices: Array | None = None
    faces: NDArray[np.int32] | None = None


@dataclass(frozen=True)
class DrawnCylinder:
    """A pneumatic cylinder between two points that move; the barrel keeps its length, the rod goes in and out.

    Attributes:
        name: The cylinder's name in the rig.
        cap: Where the barrel is held, metres, shape (frames, 3).
        end: Where the rod is held, metres, shape (frames, 3).
        barrel_length: Metres.
        bore: Outer diameter of the barrel as drawn, metres.
        rod: Diameter of the rod, metres.
    """

    name: str
    cap: Array
    end: Array
    barrel_length: float
    bore: float
    rod: float


@dataclass(frozen=True)
class Arrows:
    """A vector that moves: a ground or strap force.

    Attributes:
        name: What it is.
        origins: Metres, shape (frames, 3).
        vectors: In its own unit, shape (frames, 3).
        metres_per_unit: Length of the arrow; by default a newton is a millimetre.
        rgba: Each 0 to 1.
    """

    name: str
    origins: Array
    vectors: Array
    metres_per_unit: float = 1e-3
    rgba: Rgba = (0.95, 0.75, 0.1, 1.0)


@dataclass(frozen=True)
class Scene:
    """Everything to draw.

    Attributes:
        times: Seconds, shape (frames,). A hundred a second are plenty.
        bodies: Names.
        positions: Of the bodies' frames, metres, shape (frames, bodies, 3).
        quaternions: Of the bodies' frames, w first, shape (frames, bodies, 4).
        shapes: What the bodies look like.
        cylinders: Pneumatic cylinders.
        arrows: Forces.
        follow: Name of the body that the eye goes with, if any.
    """

    times: Array
    bodies: Sequence[str]
    positions: Array
    quaternions: Array
    shapes: Sequence[Shape] = ()
    cylinders: Sequence[DrawnCylinder] = ()
    arrows: Sequence[Arrows] = ()
    follow: str | None = None


def shapes_of_model(model: Any, hidden_groups: Sequence[int] = (3, 4, 5)) -> tuple[tuple[str, ...], tuple[Shape, ...]]:
    """Return the bodies and shapes of a MuJoCo model, for `Scene(bodies=..., shapes=...)`.

    Args:
        model: An `mjModel`; only read.
        hidden_groups: Geom groups that are not drawn, as in MuJoCo's viewer.

    Returns:
        Names of all bodies (`data.xpos` and `data.xquat` in their order are the positions and quaternions), and the
        shapes. Planes and height fields are left out.
    """
    bodies = tuple(model.body(i).name or f"body_{i}" for i in range(model.nbody))
    shapes = []
    for i in range(model.ngeom):
        kind = _KINDS.get(int(model.geom_type[i]))
        rgba = model.geom_rgba[i]
        material = int(model.geom_matid[i])
        if material >= 0:
            rgba = model.mat_rgba[material]
        if kind is None or int(model.geom_group[i]) in hidden_groups or rgba[3] == 0.0:
            continue
        vertices = faces = None
        if kind == "mesh":
            mesh = int(model.geom_dataid[i])
            first, face = int(model.mesh_vertadr[mesh]), int(model.mesh_faceadr[mesh])
            vertices = np.array(model.mesh_vert[first : first + int(model.mesh_vertnum[mesh])], dtype=np.float64)
            faces = np.array(model.mesh_face[face : face + int(model.mesh_facenum[mesh])], dtype=np.int32)
        shapes.append(
            Shape(
                model.geom(i).name or f"geom_{i}",
                int(model.geom_bodyid[i]),
                kind,
                np.array(model.geom_size[i]),
                np.array(model.geom_pos[i]),
                np.array(model.geom_quat[i]),
                (float(rgba[0]), float(rgba[1]), float(rgba[2]), float(rgba[3])),
                vertices,
                faces,
            )
        )
    return bodies, tuple(shapes)
