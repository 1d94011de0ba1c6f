"""A valve whose four metering edges are not alike."""

from __future__ import annotations

from collections.abc import Mapping

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.effects import valve_characteristic

#: The four edges, in the order of the valve's paths: from the supply to a chamber, from a chamber to the exhaust.
EDGES = ("supply_1", "exhaust_1", "supply_2", "exhaust_2")

_LAP = "zero lap 0-1 %, closed centre 2-5 %, open centre -1 to -5 % of full command; edges of one spool differ by a quarter of it"
_SIZE = "exhaust edges of directional valves pass 0.6-0.8 of what supply edges do; edges of one spool differ by 5-10 % (estimate)"


def _says_something(place: str, given: Mapping[str, float], curves: Mapping[str, tuple[float, ...]]) -> str:
    return "" if given else "give the overlap or the excess of at least one edge, like overlap_supply_1 = 0.02"


EFFECT = Effect(
    name="valve_edges",
    places=("cylinder",),
    family="valve",
    question="Do the four paths of the valve open at different commands, or to different areas?",
    says="The four metering edges of the valve differ in overlap or in area.",
    parameters=(
        *(Parameter(f"overlap_{edge}", "1", -0.5, 0.9, (-0.02, 0.08), _LAP, required=False) for edge in EDGES),
        *(Parameter(f"excess_{edge}", "1", -0.95, 4.0, (-0.3, 0.3), _SIZE, required=False) for edge in EDGES),
    ),
    cut="gas",
    check=_says_something,
    needs_valve=True,
    reveals=("pressure_1", "pressure_2"),
    needs=("valve_command",),
    mistaken_for=("valve_deadband", "valve_offset", "valve_null_leakage", "flow_capacity"),
    experiment="lock the rod and ramp the command slowly through zero, both ways: each chamber's fill and vent show one edge each",
    convention=(
        "overlap is the command at which an edge begins to open, towards its own side, beyond the width of valve_deadband where the rig "
        "has one; negative where it opens before, and underlap where it is then open at zero command still. Full opening stays at full "
        "command: (u - overlap)/(1 - overlap). excess is the edge's area over the rig's, less one. Four equal overlaps are "
        "valve_deadband; the shift of valve_offset comes before."
    ),
    valid="each edge opens in proportion to the command from where it begins, whatever the pressures.",
    signature="fills and vents of either chamber start at different commands, or differ in size at the same one",
    identification=Identification(
        forms=((*(f"overlap_{edge}" for edge in EDGES), *(f"excess_{edge}" for edge in EDGES)),),
        starts=((*(0.0 for _ in EDGES), *(0.0 for _ in EDGES)), (*(0.004, -0.004, 0.004, -0.004), *(0.0 for _ in EDGES))),
        jerky=True,
        healthy={**{f"excess_{edge}": (0.05, 0.15) for edge in EDGES}, **{f"overlap_{edge}": (0.002, 0.01) for edge in EDGES}},
        known={**{f"overlap_{edge}": (0.0, 0.01) for edge in EDGES}, **{f"excess_{edge}": (0.0, 0.05) for edge in EDGES}},
        least={**{f"overlap_{edge}": 0.03 for edge in EDGES}, **{f"excess_{edge}": 0.15 for edge in EDGES}},
        is_law=True,
        on_top_of="valve_deadband",
        common=("width", tuple(f"overlap_{edge}" for edge in EDGES)),
        multiplies=("valve_area", tuple(f"excess_{edge}" for edge in EDGES)),
        counts_from={
            "flow_capacity": "Excess counts from a valve area that is {} than the rig's, as in improved.toml.",
            "valve_deadband": "Overlap counts from the end of the dead band that is named beside it.",
        },
    ),
)


@kernel
def present(p) -> bool:
    """Return whether any edge differs from the paper's."""
    if p.overlap_supply_1 != 0.0 or p.overlap_exhaust_1 != 0.0 or p.overlap_supply_2 != 0.0 or p.overlap_exhaust_2 != 0.0:
        return True
    return p.excess_supply_1 != 0.0 or p.excess_exhaust_1 != 0.0 or p.excess_supply_2 != 0.0 or p.excess_exhaust_2 != 0.0


@kernel
def opening(command: float, overlap: float, characteristic) -> float:
    """Return the relative opening of an edge, 0 to 1, under a command that is positive where it opens the edge.

    Args:
        characteristic: Numbers of `valve_characteristic`.
    """
    if valve_characteristic.present(characteristic):
        return valve_characteristic.curved(characteristic, (command - overlap) / max(1.0 - overlap, 1e-6))
    return min(max(command - overlap, 0.0) / max(1.0 - overlap, 1e-6), 1.0)


@kernel
def path_areas(
    p, characteristic, command_1: float, command_2: float, width: float, area: float, closed_area: float
) -> tuple[float, float, float, float]:
    """Return the areas supply->1, 1->exhaust, supply->2, 2->exhaust [m^2].

    Args:
        characteristic: Numbers of `valve_characteristic`.
        command_1, command_2: Of the spool to each chamber, before any dead-band; opposite of each other where one spool serves both.
        width: Of the dead-band, which every overlap comes on top of.
        area, closed_area: As of `valve_areas.path_areas`.
    """
    return (
        area * (1.0 + p.excess_supply_1) * opening(command_1, width + p.overlap_supply_1, characteristic) + closed_area,
        area * (1.0 + p.excess_exhaust_1) * opening(-command_1, width + p.overlap_exhaust_1, characteristic) + closed_area,
        area * (1.0 + p.excess_supply_2) * opening(command_2, width + p.overlap_supply_2, characteristic) + closed_area,
        area * (1.0 + p.excess_exhaust_2) * opening(-command_2, width + p.overlap_exhaust_2, characteristic) + closed_area,
    )
