"""Real cylinders and what is published of their parts.

Bores, rods and strokes are those of ISO 6432 (8 to 25 mm) and ISO 15552 (32 to 125 mm), of tie-rod cylinders in inches (NFPA, ANSI B93.15:
bores of 1 1/2, 2 and 2 1/2 in on a rod of 5/8 in), and of compact cylinders (ISO 21287). Sizes of effects (`effect_sizes`) come from data
sheets and papers: seal friction of 0.2 to 1 N per millimetre of bore and 1.3 to 2.5 times that at breakaway; viscous friction of 1 to
5 N s/m per millimetre (Carneiro and de Almeida 2012); heat of 15 to 90 W/(m^2 K) at the wall; dead volumes of 4 to 20 % of the swept one
with fittings; leaks from the tightness of new seals (ISO 10099) to a hundredfold for worn ones; valves with b of 0.15 to 0.48, dead bands
of 1 to 12 %, lags of 2 to 18 ms.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Size:
    """One size of cylinder: bore, rod [m], the strokes it is sold with [m], and the largest load that people move with it [kg]."""

    bore: float
    rod: float
    strokes: tuple[float, ...]
    load: float

    @property
    def area(self) -> float:
        """Piston area [m^2]."""
        return 0.25 * math.pi * self.bore**2


def _size(bore: float, rod: float, strokes: tuple[float, ...], load: float) -> Size:
    return Size(bore * 1e-3, rod * 1e-3, tuple(stroke * 1e-3 for stroke in strokes), load)


SIZES = {
    size[0]: _size(*size)
    for size in (
        (10.0, 4.0, (40.0, 50.0, 80.0), 0.8),
        (12.0, 6.0, (50.0, 80.0, 100.0), 1.2),
        (16.0, 6.0, (50.0, 80.0, 100.0, 160.0), 2.5),
        (20.0, 8.0, (80.0, 100.0, 160.0, 200.0), 4.0),
        (25.0, 10.0, (80.0, 100.0, 160.0, 200.0, 250.0), 8.0),
        (32.0, 12.0, (80.0, 100.0, 160.0, 200.0, 320.0), 14.0),
        (40.0, 16.0, (100.0, 160.0, 200.0, 320.0), 24.0),
        (50.0, 20.0, (100.0, 160.0, 250.0, 320.0), 40.0),
        (63.0, 20.0, (100.0, 160.0, 250.0), 65.0),
        (80.0, 25.0, (100.0, 160.0, 200.0), 110.0),
    )
}

INCH = {
    size[0]: _size(*size)
    for size in (
        (38.1, 15.875, (101.6, 152.4, 203.2), 22.0),
        (50.8, 15.875, (101.6, 152.4, 203.2, 254.0), 40.0),
        (63.5, 15.875, (152.4, 203.2, 254.0), 65.0),
    )
}
COMPACT = {
    size[0]: _size(*size)
    for size in (
        (25.0, 10.0, (40.0, 50.0, 60.0, 80.0), 7.0),
        (40.0, 12.0, (40.0, 50.0, 60.0, 80.0), 22.0),
        (63.0, 16.0, (50.0, 60.0, 80.0), 60.0),
    )
}
SERIES = {"iso": SIZES, "inch": INCH, "compact": COMPACT}

#: Bore and length [m] of hoses.
HOSE_BORES = (2.5e-3, 4e-3, 5.5e-3, 7e-3, 9e-3)


def hose_conductance(bore: float, length: float) -> tuple[float, float]:
    """Return C [m^3/(s Pa)] and b of a smooth hose (ISO 6358-3, annex on tubes)."""
    sonic = 0.029 * bore**2 / math.sqrt(length / bore**1.25 + 510.0)
    return sonic, 474.0 * sonic / bore**2


def throat_area(sonic_conductance: float) -> float:
    """Return the throat area of a nozzle [m^2] that chokes at the same flow as a sonic conductance [m^3/(s Pa)] of air."""
    return sonic_conductance * 1.185 * math.sqrt(293.15) / 0.040418
