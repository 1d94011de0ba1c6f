"""Which parts of a machine touch the ground, where what it does to them must be known."""

from __future__ import annotations

from collections.abc import Iterable

import mujoco


def without_ground_force(model: mujoco.MjModel, sites: Iterable[int]) -> str:
    """Return the first body by name that can touch something and has none of these sites, whose ground force is known; "" where all have.

    A machine with hardly more degrees of freedom than motors is bolted to something: what of it could touch does not count unless some
    ground force is known.
    """
    known = {int(model.site_bodyid[site]) for site in sites}
    touching = set(model.geom_bodyid[(model.geom_contype != 0) & (model.geom_bodyid != 0)].tolist())
    lacking = sorted(model.body(body).name for body in touching - known)
    return lacking[0] if lacking and (known or model.nv > model.nu + 1) else ""
