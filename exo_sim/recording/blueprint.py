"""How the viewer lays a recording out: the scene, plots in tabs by joint, the gait and other lanes below."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from exo_sim import signals
from exo_sim.recording import columns, rrd_names
from exo_sim.recording.scene import Scene
from exo_sim.recording.table import Recording
from exo_sim.signals import VALVE_COMMANDS

if TYPE_CHECKING:
    import rerun.blueprint as rrb

SCENE = "scene"
LANES = "lanes"
DIFFERENCE = "difference"

_WORKING = ("ground", "damping", "spring", "actuator", "torso_strap", "thigh_strap", "shoe_strap")
#: Plots of a tab, from top to bottom, and the signals in each; those of another unit get a plot of their own.
_PLOTS = (
    ("pressure", ("pressure_1", "pressure_2", "pressure")),
    ("rod force", ("force", "force_demanded")),
    ("joint load", ("torque", "torque_demanded", "wearer_moment", "wearer_total_moment", "external_force")),
    ("valve command, choked paths", (*VALVE_COMMANDS, "choked")),
    ("position", ("position", "length")),
    ("velocity", ("velocity",)),
    ("temperature", ("temperature_1", "temperature_2", "temperature")),
    ("gas drawn", ("gas_used",)),
    ("ground force", ("ground_force_x", "ground_force_y", "ground_force_z")),
    ("strap force", ("strap_force_x", "strap_force_y", "strap_force_z")),
    ("power of the wearer's joint", ("wearer_power",)),
    ("where the ground pushes", ("pressure_centre",)),
    ("ground force on the wearer", ("wearer_force_x", "wearer_force_z")),
    ("centre of pressure", ("wearer_pressure_centre",)),
    ("power on the machine", tuple(f"{name}_power" for name in _WORKING)),
    ("residual at the pelvis", ("residual_force_x", "residual_force_z", "residual_moment")),
    ("gait phase", ("phase",)),
)
#: A tab of more plots than this has two columns.
_MOST_ROWS = 4
_OTHERS = "other joints"
_SITES = {"ground": "ground", "pressure": "ground", "strap": "straps", "wearer": "wearer"}


def tabs(recording: Recording) -> dict[str, list[str]]:
    """Return the tabs and the columns in each: one a joint with its cylinder, then the rest of the machine.

    The rest is other joints, ground, straps and supply. A machine of one cylinder and one joint has them in one tab.
    """
    kinds: dict[str, set[str]] = {"cylinder": set(), "joint": set()}
    tab_of: dict[str, str] = {}
    for key in recording.columns:
        part = key.rsplit(".", 1)[0]
        signal = columns.signal_of(key)
        tab_of[key] = part
        if signal.part in kinds:
            kinds[signal.part].add(part)
        elif signal.part == "site":
            tab_of[key] = _SITES[signal.name.split("_", 1)[0]]
        elif part in ("supply", "exhaust"):
            tab_of[key] = "supply"
    alone = kinds["cylinder"] | kinds["joint"]
    if len(kinds["cylinder"]) == 1 and len(kinds["joint"]) == 1:
        name = " and ".join(sorted(alone, key=list(recording.parts()).index))
        tab_of = {key: name if tab in alone else tab for key, tab in tab_of.items()}
    elif kinds["cylinder"] and len(kinds["joint"] - kinds["cylinder"]) > 1:
        tab_of = {key: _OTHERS if tab in kinds["joint"] - kinds["cylinder"] else tab for key, tab in tab_of.items()}
    gathered: dict[str, list[str]] = {}
    for key, tab in tab_of.items():
        if columns.signal_of(key).part != "gait":
            gathered.setdefault(tab, []).append(key)
    last = (_OTHERS, "ground", "straps", "wearer", "ledger", "supply")
    return {tab: gathered[tab] for tab in sorted(gathered, key=lambda tab: tab in last and 1 + last.index(tab))}


def plots(keys: Sequence[str], units: Mapping[str, str]) -> list[tuple[str, list[str]]]:
    """Return the plots of one tab from top to bottom: title with the unit, and columns, all of that unit."""
    found: list[tuple[str, list[str]]] = []
    for title, names in _PLOTS:
        of_plot = [key for key in keys if key.rsplit(".", 1)[1] in names]
        for unit in dict.fromkeys(units.get(key, "") for key in of_plot):
            unit_of_title = "" if unit in ("", "1") else f", {rrd_names.shown(unit)[0]}"
            found.append((title + unit_of_title, [key for key in of_plot if units.get(key, "") == unit]))
    return found


def places(recording: Recording) -> dict[str, int]:
    """Return which line of its plot each column is, so that neighbours can differ in colour."""
    return {
        key: place for keys in tabs(recording).values() for _, shown in plots(keys, recording.units) for place, key in enumerate(shown)
    }


def layout(
    recording: Recording, *, scene: Scene | None, lanes: Sequence[str], overlaid: Mapping[str, bool]
) -> rrb.Blueprint:
    """Return the blueprint.

    Args:
        recording: What is shown.
        scene: What is drawn in space.
        lanes: Names of the lanes below the plots.
        overlaid: Columns that also show simulated values: each gets a plot of its own, and one of the difference beside it.
    """
    import rerun.blueprint as rrb

    pages = [_page(tab, _views(keys, overlaid, recording.units)) for tab, keys in tabs(recording).items()]
    right: rrb.Container | rrb.View = rrb.Tabs(*pages, active_tab=0)
    if lanes:
        height = 0.05 + 0.05 * len(lanes)
        lane_view = rrb.StateTimelineView(origin=f"/{LANES}", name="when")
        right = rrb.Vertical(right, lane_view, row_shares=[1.0 - height, height])
    whole: rrb.Container | rrb.View = right
    if scene is not None:
        space = rrb.Spatial3DView(
            origin=f"/{SCENE}",
            name="machine",
            line_grid=rrb.LineGrid3D(visible=True, spacing=0.5),
            background=rrb.Background(color=[38, 42, 48]),
            eye_controls=_eye(scene),
        )
        whole = rrb.Horizontal(space, right, column_shares=[2, 3])
    return rrb.Blueprint(
        whole,
        rrb.TimePanel(state="collapsed", timeline="time"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
        auto_views=False,
        auto_layout=False,
    )


def _page(tab: str, views: list[rrb.TimeSeriesView]) -> rrb.Container:
    import rerun.blueprint as rrb

    if len(views) > _MOST_ROWS:
        return rrb.Grid(*views, grid_columns=2, name=tab)
    return rrb.Vertical(*views, name=tab)


def _eye(scene: Scene) -> rrb.EyeControls3D:
    """Look from the right and a little from the front, near enough to see the machine, and go with it."""
    import rerun.blueprint as rrb

    drawn = sorted({shape.body for shape in scene.shapes}) or list(range(len(scene.bodies)))
    first = scene.positions[0, drawn]
    low, high = first.min(axis=0), first.max(axis=0)
    middle, size = (low + high) / 2.0, max(float((high - low).max()), 0.2)
    eye = middle + 1.35 * size * np.array([0.75, -1.3, 0.35])
    return rrb.EyeControls3D(
        position=eye,
        look_target=middle,
        eye_up=(0.0, 0.0, 1.0),
        tracking_entity=_followed(scene),
    )


def _followed(scene: Scene) -> str | None:
    """Return the shape that the eye goes with: rerun follows what it draws, not a bare frame."""
    of_body = (shape for shape in scene.shapes if scene.bodies[shape.body] == scene.follow)
    first = next(of_body, None)
    return f"/{body_path(scene.bodies[first.body])}/{safe(first.name)}" if first else None


def body_path(body: str) -> str:
    """Return the entity of a body."""
    return f"{SCENE}/bodies/{safe(body)}"


def safe(name: str) -> str:
    """Return a name that may stand in an entity path."""
    return "".join(c if c.isalnum() or c in "_-." else "_" for c in name)


def _views(keys: Sequence[str], overlaid: Mapping[str, bool], units: Mapping[str, str]) -> list[rrb.TimeSeriesView]:
    import rerun.blueprint as rrb

    groups: list[tuple[str, list[str]]] = []
    if any(overlaid.get(key) for key in keys):
        for key in keys:
            if overlaid.get(key):
                difference = f"simulated less recorded, {rrd_names.shown(units[key])[0]}"
                groups += [(words(key, units[key]), [rrd_names.entity(key)]), (difference, [f"{DIFFERENCE}/{rrd_names.entity(key)}"])]
        keys = [key for key in keys if not overlaid.get(key)]
    groups += [(title, [rrd_names.entity(key) for key in shown]) for title, shown in plots(keys, units)]
    legend = rrb.PlotLegend(rrb.Corner2D.RightTop)
    axis = rrb.TimeAxis(link=rrb.components.LinkAxis.LinkToGlobal)
    return [
        rrb.TimeSeriesView(
            origin="/",
            contents=[path for entity in shown for path in (f"/{entity}", f"/{entity}/**")],
            name=title,
            plot_legend=legend,
            axis_x=axis,
        )
        for title, shown in groups
    ]


def words(key: str, unit: str) -> str:
    """Return what to call a column in a plot: part, signal and the unit that it is shown in."""
    part = key.rsplit(".", 1)[0]
    signal: signals.Signal = columns.signal_of(key)
    return f"{part}: {signal.label}" + ("" if unit in ("", "1") else f", {rrd_names.shown(unit)[0]}")
