"""One machine with all its recordings, sorted by the balances that can be judged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import mujoco

from exo_sim.conventions import Check
from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.findings import Finding, OpenQuestion, Subsystem
from exo_sim.machine.linkage import Linkage
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig


@dataclass(frozen=True)
class MachineData:
    """The nominal rig, and what the recordings hold. A stage that learns more returns a new one.

    Attributes:
        rig, model, links: The machine.
        as_read: The recordings as they were handed in, in the conventions of the format.
        recordings: The same without what their sensors cannot have seen.
        cylinders: By cylinder, the runs whose gas can be judged.
        joints: The balances of forces that can be judged, by joint, or by "rod of CYLINDER" along a rod with a load cell.
        sensors: Faults of sensors that were found before any physics was asked.
        remarks: Plain sentences about clocks and sensors.
        open_questions: What cannot be judged, and why.
        externally_driven: Joints that somebody moved or held by forces that were not measured.
        fed: Cylinders that were fed by something of which no command was recorded.
        checks: What was asked of the recordings, and put right, before any physics.
        zeros_within: By column, how far off its zero can be at most by what the gas tells of a pressure [Pa], and the balance of a
            joint of the load cell in it [N or N m].
    """

    rig: Rig
    model: mujoco.MjModel
    links: tuple[Linkage, ...]
    as_read: tuple[Recording, ...]
    recordings: tuple[Recording, ...]
    cylinders: Mapping[str, tuple[CylinderRun, ...]]
    joints: Mapping[str, tuple[MotionRun, ...]]
    sensors: tuple[Finding, ...] = ()
    remarks: tuple[str, ...] = ()
    open_questions: tuple[OpenQuestion, ...] = ()
    externally_driven: frozenset[str] = frozenset()
    fed: frozenset[str] = frozenset()
    checks: tuple[Check, ...] = ()
    zeros_within: Mapping[str, float] = field(default_factory=dict)

    @property
    def needed_for_verdict(self) -> frozenset[Subsystem]:
        """The kinds of subsystem of which one must have been judged before the machine can be said to be as its rig.

        Forces are not among them where a body floats, joints hang on the machine that no cylinder moves, or somebody led every piston by
        forces that were not measured: the gas is judged all the same. Gas is not where what feeds every cylinder is no part of the rig.
        """
        if all(name in self.fed and cylinder.valve_area <= 0.0 for name, cylinder in self.rig.cylinders.items()):
            return frozenset({Subsystem.MOTION})
        floats = any(int(kind) in (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL) for kind in self.model.jnt_type)
        free = floats or self.model.njnt > len(self.rig.cylinders) + 1
        led = bool(self.externally_driven) and all(link.joint in self.externally_driven for link in self.links)
        return frozenset({Subsystem.GAS} if free or led else {Subsystem.GAS, Subsystem.MOTION})

    def joint_of(self, cylinder: str) -> str:
        """Return the joint that a cylinder drives."""
        return next(link.joint for link in self.links if link.cylinder == cylinder)

    def table(self, name: str) -> Recording:
        """Return a recording by its name."""
        return next(table for table in self.recordings if table.name == name)
