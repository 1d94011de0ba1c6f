"""Practical significance: a smaller drop of the root mean square error concerns nobody, however certain it is."""

from __future__ import annotations

from exo_sim.deciding_number import Number

GAS_SIGNIFICANT = Number(1e-4, "share of the pressure", "a smaller drop of the error is not practically significant: sensors drift as much")
FORCE_SIGNIFICANT = Number(2e-4, "share of the full force", "a smaller drop of the error is not practically significant")
SUPPLY_SIGNIFICANT = Number(2e-3, "share of the pressure", "a supply that strays by less concerns nobody")
