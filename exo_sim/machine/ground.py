"""What is walked on: level ground, a slope, or stairs, as numbers and as geoms of a MuJoCo model."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from exo_sim.errors import ScenarioError

if TYPE_CHECKING:
    import mujoco

#: The steepest slope and the steepest stairs that are walked, and the stairs' shortest and longest tread [m].
STEEPEST_SLOPE, STEEPEST_STAIRS, TREADS = 0.15, 0.8, (0.22, 0.45)
#: A staircase has so many treads at the most.
MOST_TREADS = 200
#: The body that stairs are.
STAIRS = "stairs"
#: Half of a tread's width, and of its thickness [m].
_WIDE, _THICK = 1.0, 0.5


@dataclass(frozen=True)
class Ground:
    """Ground that rises evenly ahead, through the origin.

    Attributes:
        grade: Rise over run; below zero it falls.
        tread: Depth of each step of stairs [m]; 0 where it is a slope. The edge of one tread is at `edge`, with the tread ahead of it
            higher by `grade * tread`.
        edge: Where the tread at height 0 begins [m].

    Raises:
        ScenarioError: steeper than anybody walks, or treads that no foot fits.
    """

    grade: float = 0.0
    tread: float = 0.0
    edge: float = 0.0

    def __post_init__(self) -> None:
        if self.tread == 0.0:
            if not abs(self.grade) <= STEEPEST_SLOPE:
                most = STEEPEST_SLOPE
                raise ScenarioError(f"slope: grade = {self.grade:g}: write -{most:g} to {most:g}, rise over run, or stairs instead")
            return
        if not TREADS[0] <= self.tread <= TREADS[1]:
            raise ScenarioError(f"stairs: tread = {self.tread:g} m: write {TREADS[0]:g} m to {TREADS[1]:g} m, which a foot fits")
        if not abs(self.grade) <= STEEPEST_STAIRS:
            most = STEEPEST_STAIRS * self.tread
            raise ScenarioError(f"stairs: rise = {self.grade * self.tread:g} m: write -{most:.2g} m to {most:.2g} m for such treads")

    @property
    def angle(self) -> float:
        """By how much a sole that lies on it is turned, toes up positive [rad]."""
        return 0.0 if self.tread else math.atan(self.grade)

    @property
    def level(self) -> bool:
        """Whether it does not rise."""
        return self.grade == 0.0

    def height(self, ahead: float) -> float:
        """Return how high it is at a place [m]."""
        return self.grade * (self.tread * math.floor((ahead - self.edge) / self.tread) if self.tread else ahead)

    def lay(self, spec: mujoco.MjSpec, length: float) -> None:
        """Put it into a specification of a worn machine, in place of the level floor, for a walk of some length [m].

        Raises:
            ScenarioError: so many treads that nobody builds such stairs.
        """
        import mujoco

        floor = spec.geom("floor")
        if self.level:
            return
        if not self.tread:
            floor.quat = [math.cos(0.5 * self.angle), 0.0, -math.sin(0.5 * self.angle), 0.0]
            return
        count = math.ceil(length / self.tread) + 4
        if count > MOST_TREADS:
            raise ScenarioError(f"stairs of {count} treads: ask for fewer strides, for {MOST_TREADS} treads at the most")
        rise = self.grade * self.tread
        floor.pos = [0.0, 0.0, min(0.0, count * rise) - 2.0 * _THICK - 1.0]
        stairs = spec.worldbody.add_body(name=STAIRS)
        for i in range(-2, count - 2):
            stairs.add_geom(
                name=f"tread_{i}", type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.5 * self.tread, _WIDE, _THICK],
                pos=[self.edge + (i + 0.5) * self.tread, 0.0, i * rise - _THICK], contype=0, conaffinity=1, rgba=[0.75, 0.77, 0.8, 1.0],
            )  # fmt: skip
        for side in "lr":
            sensor = spec.sensor(f"ground_{side}")
            sensor.reftype, sensor.refname = mujoco.mjtObj.mjOBJ_BODY, STAIRS


LEVEL = Ground()
