"""Whether sizes that no fit moves (bore, rod, stroke, moment arm) may be wrong: what then must be checked before any finding is believed.

A bore that is off by a factor makes valve, dead volumes and mass all look off by its square: gas and forces know nothing but their ratios
to the piston's area. And a rig that was improved in many ways, each certain by itself, then still fails when it is run free.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence

from exo_sim.diagnosis.findings import Finding, Kind, SignalFit
from exo_sim.diagnosis.nominal_numbers import DEAD_VOLUME, FLOW_CAPACITY, PAYLOAD_MASS
from exo_sim.diagnosis.policy.off_nominal import FEWEST_ALIKE, SAME_FACTOR, WRONG_AREA
from exo_sim.diagnosis.policy.validation import NO_BETTER, STILL_FAR
from exo_sim.rig import Rig


def suspected_bores(findings: Sequence[Finding], rig: Rig, joint_of: Mapping[str, str]) -> dict[str, float]:
    """Return, by cylinder, the bore [m] that would make numbers right which are all off by about one factor.

    Args:
        findings: All of them.
        rig: The rig as handed in.
        joint_of: By cylinder, the joint that it drives without a lever: the mass that it moves then goes with its area as well.
    """
    found = {}
    for name, cylinder in rig.cylinders.items():
        factors = _factors(findings, name, joint_of.get(name, ""))
        if len(factors) < FEWEST_ALIKE or min(factors) <= 0.0:
            continue
        mean = math.exp(sum(map(math.log, factors)) / len(factors))
        alike = max(factors) < SAME_FACTOR * min(factors)
        if alike and (min(factors) > 1.0 + WRONG_AREA or max(factors) < 1.0 - WRONG_AREA):
            found[name] = cylinder.bore / math.sqrt(mean)
    return found


def still_far(free_run: Mapping[str, SignalFit]) -> tuple[str, SignalFit] | None:
    """Return the signal that an improved rig, run free, misses hardly less than the one handed in, and plainly; None where none is."""
    far = {
        key: fit
        for key, fit in free_run.items()
        if math.isfinite(fit.before) and fit.noise > 0.0 and fit.after > STILL_FAR * fit.noise and fit.after > NO_BETTER * fit.before
    }
    return max(far.items(), key=lambda pair: pair[1].after / pair[1].noise, default=None)


def advice(
    findings: Sequence[Finding], free_run: Mapping[str, SignalFit], bores: Mapping[str, float], rig: Rig, levers: Collection[str] = ()
) -> str:
    """Return what sizes to check and why, as a clause of an advice; "" where nothing speaks for that.

    Args:
        findings: All of them: without one nothing was improved.
        free_run: Errors of the rig as handed in and of the improved one.
        bores: As of `suspected_bores`.
        rig: The rig as handed in.
        levers: Cylinders that drive a joint by a lever.
    """
    if bores and findings:
        name, bore = next(iter(bores.items()))
        cylinder = f"cylinders.{name} of {rig.path}"
        return (
            f"bore in {cylinder}, {1e3 * rig.cylinders[name].bore:.3g} mm: what goes with the piston's area (valve, dead volumes, mass) is "
            f"off by about one factor, as it would be with a bore of {1e3 * bore:.3g} mm"
        )
    if not findings or still_far(free_run) is None:
        return ""
    arm = ", moment arm" if levers else ""
    return f"bore, rod, stroke{arm} and mass in {rig.path}" if rig.cylinders else f"masses and lengths in {rig.path}"


def _factors(findings: Sequence[Finding], cylinder: str, joint: str) -> list[float]:
    """Return by how much each number that goes with a piston's area is off."""
    found = []
    for one in findings:
        if one.kind is not Kind.CALIBRATION:
            continue
        parts = {key: estimate.value for key, estimate in one.parameters.items()}
        if one.name == DEAD_VOLUME and one.where == cylinder:
            found += [value for key, value in parts.items() if key != "factor"]
        elif (one.name, one.where) in ((FLOW_CAPACITY, cylinder), (PAYLOAD_MASS, joint)):
            found.append(parts.get("factor", 1.0))
    return found
