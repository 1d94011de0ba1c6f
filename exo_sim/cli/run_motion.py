"""What `exo-sim run MOTION --rig RIG` prints: a machine that nobody wears follows a recorded motion."""

from __future__ import annotations

from typing import Any

from exo_sim.cli import printing


def motion_words(data: dict[str, Any]) -> str:
    """Return the result as a short report."""
    rows = []
    for name, one in data["joints"].items():
        turns = "position_error_rms_rad" in one
        unit, factor = ("deg", 57.29577951308232) if turns else ("mm", 1e3)
        key, force, newton = ("rad", "torque", "nm") if turns else ("m", "force", "n")
        rows.append([
            name, f"{factor * one[f'position_error_rms_{key}']:.2f} {unit}", f"{factor * one[f'position_error_peak_{key}']:.2f} {unit}",
            f"{one[f'{force}_rms_{newton}']:.1f}", f"{one[f'{force}_peak_{newton}']:.1f} {'N m' if turns else 'N'}",
        ])  # fmt: skip
    cylinders = [
        [name, f"{one['pressure_peak_pa'] / 1e5:.1f}", f"{100 * one['choked_share']:.0f}", f"{one['force_error_rms_n']:.1f}",
         f"{1e3 * one['gas_kg']:.2f}"]
        for name, one in data["cylinders"].items()
    ]  # fmt: skip
    books = data["books"]
    return "\n".join([
        f"{data['scenario']}: {data['simulated_s']:.2f} s simulated in {data['wall_s']:.2f} s{printing.compiling(data['compiled_s'])}", "",
        printing.table(rows, ["joint", "error rms", "error peak", "made rms", "made peak"]), "",
        printing.table(cylinders, ["cylinder", "peak bar", "paths choked %", "force error rms N", "gas g"]), "",
        f"conservation error, relative: gas mass {books['gas_mass_residual']:.0e}, energy {books['gas_energy_residual']:.0e}",
        f"recording {data['recording']}, table {data['table']}",
    ])  # fmt: skip
