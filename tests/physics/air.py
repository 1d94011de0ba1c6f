"""Air and the atmosphere of the paper, in SI."""

from __future__ import annotations

K, R, PA = 1.4, 287.05, 101325.0
CV, CP = R / (K - 1), K * R / (K - 1)
