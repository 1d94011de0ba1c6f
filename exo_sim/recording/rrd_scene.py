"""Drawing a scene with rerun: shapes once, the motion of their bodies as whole columns."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.recording.blueprint import SCENE, body_path, safe
from exo_sim.recording.rrd_timeline import clock
from exo_sim.recording.scene import Arrows, DrawnCylinder, Scene, Shape

_BARREL = (70, 130, 190, 255)
_ROD = (215, 215, 220, 255)


class Drawing:
    """A scene in a rerun recording stream, added piece by piece."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream
        self._begun = False
        self._rests: dict[str, NDArray[np.float64]] = {}

    def add(self, scene: Scene) -> None:
        """Log a scene, or the next piece of it: the same bodies, cylinders and arrows at later times."""
        import rerun as rr

        stream, first, index = self._stream, not self._begun, [clock(scene.times)]
        self._begun = True
        if first:
            stream.log(SCENE, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
            for shape in scene.shapes:
                stream.log(f"{body_path(scene.bodies[shape.body])}/{safe(shape.name)}", _archetype(shape), static=True)
        for body in sorted({shape.body for shape in scene.shapes}):
            self._move(body_path(scene.bodies[body]), scene.times, scene.positions[:, body], scene.quaternions[:, body])
        for cylinder in scene.cylinders:
            _cylinder(stream, index, cylinder, first)
        for arrows in scene.arrows:
            _arrows(stream, index, arrows, first)

    def _move(
        self, path: str, times: NDArray[np.float64], positions: NDArray[np.float64], quaternions: NDArray[np.float64]
    ) -> None:
        """Log where a body goes; of one that rests, where it rests, once."""
        import rerun as rr

        poses = np.concatenate([positions, np.roll(quaternions, -1, axis=-1)], axis=1)  # rerun wants w last
        if np.ptp(poses, axis=0).max() == 0.0:
            if path in self._rests and np.array_equal(self._rests[path], poses[0]):
                return
            times, poses = times[:1], poses[:1]
        self._rests[path] = poses[-1]
        moved = rr.Transform3D.columns(translation=poses[:, :3], quaternion=poses[:, 3:])
        self._stream.send_columns(path, indexes=[clock(times)], columns=moved)


def _archetype(shape: Shape) -> Any:
    import rerun as rr

    turned = np.roll(shape.quaternion, -1)
    colour = [round(255 * part) for part in shape.rgba]
    solid = rr.components.FillMode.Solid
    radius, half = float(shape.size[0]), float(shape.size[1])
    if shape.kind == "mesh":
        assert shape.vertices is not None and shape.faces is not None
        corners = shape.position + _rotated(shape.vertices, shape.quaternion)
        return rr.Mesh3D(vertex_positions=corners, triangle_indices=shape.faces, albedo_factor=colour)
    if shape.kind == "box":
        return rr.Boxes3D(
            half_sizes=[shape.size], centers=[shape.position], quaternions=[turned], colors=[colour], fill_mode=solid
        )
    if shape.kind == "capsule":  # rerun's begins at its origin, MuJoCo's is centred
        begin = shape.position - half * _axis(shape.quaternion)
        return rr.Capsules3D(
            lengths=[2.0 * half], radii=[radius], translations=[begin], quaternions=[turned], colors=[colour],
            fill_mode=solid,
        )  # fmt: skip
    if shape.kind == "cylinder":
        return rr.Cylinders3D(
            lengths=[2.0 * half], radii=[radius], centers=[shape.position], quaternions=[turned], colors=[colour],
            fill_mode=solid,
        )  # fmt: skip
    axes = shape.size if shape.kind == "ellipsoid" else np.full(3, radius)
    return rr.Ellipsoids3D(
        half_sizes=[axes], centers=[shape.position], quaternions=[turned], colors=[colour], fill_mode=solid
    )


def _axis(quaternion: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the z axis of a frame, the quaternion w first."""
    w, x, y, z = quaternion
    return np.array([2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)])


def _rotated(points: NDArray[np.float64], quaternion: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points, shape (n, 3), turned by a quaternion, w first."""
    w, axis = quaternion[0], quaternion[1:]
    across = np.cross(axis, points)
    return np.asarray(points + 2.0 * (w * across + np.cross(axis, across)))


def _cylinder(stream: Any, index: list[Any], cylinder: DrawnCylinder, first: bool) -> None:
    way = cylinder.end - cylinder.cap
    length = np.linalg.norm(way, axis=1)
    along = way / np.maximum(length, 1e-9)[:, None]
    turned = _turning_z_to(along)
    barrel = np.minimum(cylinder.barrel_length, length)
    rod = np.maximum(length - barrel, 1e-3)
    base = f"{SCENE}/cylinders/{safe(cylinder.name)}"
    _tube(
        stream,
        index,
        f"{base}/barrel",
        cylinder.cap + along * barrel[:, None] / 2,
        barrel,
        turned,
        cylinder.bore if first else None,
        _BARREL,
    )
    rods = cylinder.rod if first else None
    _tube(stream, index, f"{base}/rod", cylinder.end - along * rod[:, None] / 2, rod, turned, rods, _ROD)


def _tube(
    stream: Any,
    index: list[Any],
    path: str,
    centres: NDArray[np.float64],
    lengths: NDArray[np.float64],
    turned: NDArray[np.float64],
    diameter: float | None,
    colour: tuple[int, int, int, int],
) -> None:
    import rerun as rr

    if diameter is not None:
        look = rr.Cylinders3D.from_fields(radii=[diameter / 2], colors=[colour], fill_mode=rr.components.FillMode.Solid)
        stream.log(path, look, static=True)
    stream.send_columns(
        path, indexes=index, columns=rr.Cylinders3D.columns(lengths=lengths, centers=centres, quaternions=turned)
    )


def _turning_z_to(along: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return quaternions, w last, that turn the z axis to unit vectors of shape (frames, 3)."""
    x, y, z = along.T
    quaternion = np.stack((-y, x, np.zeros_like(x), 1.0 + z), axis=1)
    down = 1.0 + z < 1e-9
    quaternion[down] = (1.0, 0.0, 0.0, 0.0)
    return quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)


def _arrows(stream: Any, index: list[Any], arrows: Arrows, first: bool) -> None:
    import rerun as rr

    path = f"{SCENE}/forces/{safe(arrows.name)}"
    colour = [round(255 * part) for part in arrows.rgba]
    if first:
        stream.log(path, rr.Arrows3D.from_fields(colors=[colour], radii=[0.008]), static=True)
    stream.send_columns(
        path,
        indexes=index,
        columns=rr.Arrows3D.columns(vectors=arrows.vectors * arrows.metres_per_unit, origins=arrows.origins),
    )
