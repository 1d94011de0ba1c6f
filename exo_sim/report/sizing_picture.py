"""Pictures of a sizing: what the joints need inside what their cylinders can do, and the front."""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING, Any

import numpy as np

from exo_sim.sizing.design import fitted
from exo_sim.sizing.joint_kinds import JointKind
from exo_sim.sizing.loads import JOINTS, JointLoads
from exo_sim.sizing.screening import along, at
from exo_sim.sizing.study import Sizing

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from exo_sim.sizing.motion_result import MotionSizing

_LOOP = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")
_STILL, _MOVING, _HUMAN, _INK = "#e8eef4", "#8fa9bf", "#8a8a8a", "#1a1a1a"
_WIDTH = 9.4


def envelopes(sizing: Sizing) -> str:
    """Return `envelope_figure` as SVG."""
    return _svg(envelope_figure(sizing))


def envelope_figure(sizing: Sizing) -> Figure:
    """Return required torque against angle and against speed inside the capability, a row each kind of joint, as SVG."""
    kinds = sizing.task.space.kinds
    figure, panels = _panels(len(kinds), 2, 3.1)
    rig = fitted(sizing.task.rig, kinds, sizing.choice.found.design)
    for row, kind in zip(panels, kinds):
        joint, name = kind.joints[-1], kind.cylinders[-1]
        thinnest = None
        swept = np.linspace(*_extent(sizing, joint), 60)
        held = at(rig, kind, name, swept, np.zeros_like(swept)).still
        row[0].fill_between(np.degrees(swept), *held, color=_STILL, zorder=0, lw=0, label="can hold")
        for i, loads in enumerate(sizing.loads):
            angle, speed, torque = loads.column(joint)
            found = along(rig, kind, joint, name, loads)
            for panel, across in ((row[0], np.degrees(angle)), (row[1], np.degrees(speed))):
                for j, bound in enumerate(found.moving):
                    panel.plot(_closed(across), _closed(bound), color=_MOVING, lw=0.8, zorder=1,
                               label="can give at its speed" if i + j == 0 else None)  # fmt: skip
                panel.plot(_closed(across), _closed(torque), color=_LOOP[i % len(_LOOP)], lw=1.7, zorder=3, label=str(loads.condition))
            if loads.human_scaled is not None:
                human = loads.human_scaled[:, JOINTS.index(joint)]
                row[0].plot(_closed(np.degrees(angle)), _closed(human), color=_HUMAN, lw=1.0, ls="--", zorder=2,
                            label="recorded moments, scaled by mass" if i == 0 else None)  # fmt: skip
            if sizing.choice.condition == loads.condition and (walk := sizing.choice.confirmed.walk) is not None:
                last = slice(-round(walk.motion.period / walk.step), None)
                seen = [walk.columns[f"{joint}.{signal}"][last] for signal in ("position", "velocity", "torque")]
                for panel, across in zip(row, (seen[0], seen[1])):
                    panel.plot(np.degrees(across), seen[2], color=_INK, lw=0.7, zorder=2, label="walked with it")
            slack = np.minimum(found.slack(torque), found.still_slack(torque)) / np.abs(torque).max()
            thin = int(np.argmin(slack))
            if thinnest is None or slack[thin] < thinnest[0]:
                thinnest = (slack[thin], np.degrees(angle[thin]), np.degrees(speed[thin]), torque[thin])
        assert thinnest is not None
        for panel, x in ((row[0], thinnest[1]), (row[1], thinnest[2])):
            panel.plot([x], [thinnest[3]], "o", ms=6, mfc="none", mec=_INK, zorder=4)
        row[0].annotate(f"lowest margin: {100 * thinnest[0]:.0f} %", (thinnest[1], thinnest[3]), xytext=(6, 7),
                        textcoords="offset points", fontsize=8)  # fmt: skip
        row[0].set(xlabel=f"{kind.name} angle [deg]", ylabel=f"{kind.name} torque [N m]")
        row[1].set(xlabel=f"{kind.name} speed [deg/s]")
    handles, words = panels[0][0].get_legend_handles_labels()
    figure.legend(handles, words, loc="outside upper center", ncols=3, fontsize=7.5, frameon=False)
    return figure


def _extent(sizing: Sizing, joint: str) -> tuple[float, float]:
    """Return the least and the largest angle of a joint [rad], as asked for and as walked."""
    angles = [loads.column(joint)[0] for loads in sizing.loads]
    if sizing.choice.confirmed.walk is not None:
        angles.append(sizing.choice.confirmed.walk.columns[f"{joint}.position"])
    return min(float(each.min()) for each in angles), max(float(each.max()) for each in angles)


def margins(sizing: Sizing) -> str:
    """Return torque left over the cycle, by kind of joint, as SVG."""
    kinds = sizing.task.space.kinds
    figure, panels = _panels(1, len(kinds), 2.4)
    rig = fitted(sizing.task.rig, kinds, sizing.choice.found.design)
    for panel, kind in zip(panels[0], kinds):
        _margin(panel, sizing, kind, rig)
    handles, words = panels[0][0].get_legend_handles_labels()
    figure.legend(handles, words, loc="outside upper center", ncols=2, fontsize=7.5, frameon=False)
    return _svg(figure)


def _margin(panel: Axes, sizing: Sizing, kind: JointKind, rig: Any) -> None:
    joint, name = kind.joints[-1], kind.cylinders[-1]
    for i, loads in enumerate(sizing.loads):
        _, _, torque = loads.column(joint)
        found = along(rig, kind, joint, name, loads)
        phase, peak = np.linspace(0.0, 100.0, len(torque), endpoint=False), np.abs(torque).max()
        colour = _LOOP[i % len(_LOOP)]
        panel.plot(phase, 100 * found.slack(torque) / peak, color=colour, lw=1.4, label=f"{loads.condition}, moving")
        panel.plot(phase, 100 * found.still_slack(torque) / peak, color=colour, lw=0.8, ls=":", label="held still" if i == 0 else None)
    panel.axhline(0.0, color=_INK, lw=0.6)
    panel.set(xlabel="cycle of the right leg [%]", ylabel=f"{kind.name}: torque left [% of peak]")
    panel.set_ylim(min(0.0, panel.get_ylim()[0]), None)


def front(sizing: Sizing) -> str:
    """Return the front in three views, gas against mass, margin and torque error, as SVG.

    Filled: designs that no other betters; grey: others that can be built; ringed: the recommended one; squares: those walked with.
    """
    figure, panels = _panels(1, 3, 3.0)
    found, chosen = sizing.outcome.front, sizing.choice.found
    others = [one.score for one in sizing.outcome.trials if one.score.feasible]
    gas = [1e3 * one.score.gas for one in found]
    walked = {one.number for one in sizing.choice.walked}
    tried = [one.score for one in found if one.design.number in walked]
    colours = [100 * one.score.margin for one in found]
    for panel, key, scale, words in (
        (panels[0][0], "mass", 1.0, "all cylinders [kg]"),
        (panels[0][1], "margin", 100.0, "torque margin [% of peak]"),
        (panels[0][2], "error", 1.0, "torque error [N m rms]"),
    ):
        panel.plot([1e3 * s.gas for s in others], [scale * getattr(s, key) for s in others], ".", ms=3, color="#c9ced4", zorder=0)
        dots = panel.scatter(gas, [scale * getattr(one.score, key) for one in found], c=colours, s=18, cmap="viridis", zorder=2)
        panel.plot([1e3 * s.gas for s in tried], [scale * getattr(s, key) for s in tried], "s", ms=8, mfc="none", mec=_LOOP[0], zorder=3)
        panel.plot([1e3 * chosen.score.gas], [scale * getattr(chosen.score, key)], "o", ms=11, mfc="none", mec=_LOOP[1], mew=1.8, zorder=4)
        panel.set(xlabel="gas a cycle [g]", ylabel=words)
    bar = figure.colorbar(dots, ax=panels[0][2])
    bar.set_label("torque margin [%]", fontsize=8)
    bar.ax.tick_params(labelsize=panels[0][2].xaxis.get_ticklabels()[0].get_fontsize())
    return _svg(figure)


def motion_front(found: MotionSizing) -> str:
    """Return the front of a sizing along a motion in three views, gas against mass, margin and position error, as SVG; marks as `front`."""
    figure, panels = _panels(1, 3, 3.0)
    others = [one for one in found.designs if not one.fate]
    scale = ("deg", 180.0 / np.pi) if any(link.turning for link in found.judge.links) else ("mm", 1e3)
    for panel, key, factor, words in (
        (panels[0][0], "mass", 1.0, "all cylinders [kg]"),
        (panels[0][1], "margin", 100.0, "force margin [% of the largest]"),
        (panels[0][2], "position_error", scale[1], f"position error [{scale[0]} rms]"),
    ):
        panel.plot([1e3 * s.gas for s in others], [factor * getattr(s, key) for s in others], ".", ms=3, color="#c9ced4", zorder=0)
        panel.plot([1e3 * s.gas for s in found.front], [factor * getattr(s, key) for s in found.front], "o", ms=4, color=_LOOP[0], zorder=2)
        panel.plot([1e3 * found.chosen.gas], [factor * getattr(found.chosen, key)], "o", ms=11, mfc="none", mec=_LOOP[1], mew=1.8, zorder=4)
        panel.set(xlabel="gas over the motion [g]", ylabel=words)
    return _svg(figure)


def motion_forces(found: MotionSizing) -> str:
    """Return what each group's first rod must give along the motion inside what its cylinder can give, as SVG."""
    groups = found.judge.space.groups
    figure, panels = _panels(len(groups), 1, 2.4)
    for row, (group, names) in zip(panels, groups.items()):
        can, wanted = found.judge.envelope(found.chosen.rig, names[0])
        motion = found.judge.loads.motion.time
        time = np.linspace(motion[0], motion[-1], len(wanted))
        row[0].fill_between(time, *can.still, color=_STILL, lw=0, zorder=0, label="can hold")
        for i, bound in enumerate(can.moving):
            row[0].plot(time, bound, color=_MOVING, lw=0.8, zorder=1, label=None if i else "can give at its speed")
        row[0].plot(time, wanted, color=_LOOP[0], lw=1.4, zorder=2, label="wanted")
        row[0].set(xlabel="time [s]", ylabel=f"{group}: rod force [N]")
    panels[0][0].legend(fontsize=7, frameon=False, ncols=3)
    return _svg(figure)


def loads_of_all_joints(loads: JointLoads) -> str:
    """Return torque over the cycle of hip, knee and ankle, recorded moments beside it, as SVG."""
    figure, panels = _panels(1, 3, 2.4)
    phase = np.linspace(0.0, 100.0, len(loads.angle), endpoint=False)
    for panel, joint in zip(panels[0], ("hip_r", "knee_r", "ankle_r")):
        at = JOINTS.index(joint)
        panel.plot(phase, loads.torque[:, at], color=_LOOP[0], lw=1.5, label="machine needs")
        if loads.human is not None and loads.human_scaled is not None:
            panel.plot(phase, loads.human[:, at], color=_HUMAN, lw=0.9, label="recorded person")
            panel.plot(phase, loads.human_scaled[:, at], color=_HUMAN, lw=0.9, ls="--", label="scaled by mass")
        panel.set(xlabel="cycle of the right leg [%]", ylabel=f"{joint[:-2]} [N m]")
    panels[0][0].legend(fontsize=7, frameon=False)
    return _svg(figure)


def _panels(rows: int, columns: int, height: float) -> tuple[Figure, Any]:
    import matplotlib

    matplotlib.use("agg")
    from matplotlib.figure import Figure as NewFigure

    figure = NewFigure(figsize=(_WIDTH, height * rows), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False)
    for panel in panels.flat:
        panel.spines[["top", "right"]].set_visible(False)
        panel.tick_params(labelsize=8)
        panel.xaxis.label.set_size(8.5)
        panel.yaxis.label.set_size(8.5)
    return figure, panels


def _closed(values: np.ndarray) -> np.ndarray:
    return np.append(values, values[0])


def _svg(figure: Figure) -> str:
    """Return a figure as SVG; the same figure gives the same bytes."""
    import matplotlib

    with matplotlib.rc_context({"svg.hashsalt": "exo-sim", "svg.fonttype": "none"}):
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None})
    return re.sub(r"^.*?(?=<svg)", "", text.getvalue(), flags=re.DOTALL)
