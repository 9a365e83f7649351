"""Energy balance and the reference's own uncertainty."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from models.monolithic import equilibrium, solve
from tests.models.systems import turn, valve_train
from tests.models.test_energy import work_of_the_radius

from .table import Row, largest


def rows() -> Iterator[Row]:
    system = valve_train(1000, camshaft={"flexible": 1.0})
    found = solve(system, np.linspace(0.0, 1.0, 7201) * turn(1000), x0=equilibrium(system), tolerance=1e-8)
    residual = {name: largest(balance.residual) for name, balance in found.energy.items()}
    left_out = work_of_the_radius(found)
    corrected = largest(found.energy["contact"].residual - left_out)
    yield Row(
        "energy balance (stored + dissipated − supplied) to integrator tolerance",
        f"one turn at 1000 r/min, flexible camshaft, tolerance 1e-8, energies of up to "
        f"{np.max(found.stored_energy):.1f} J; largest residual in J: "
        + ", ".join(f"{name} {value}" for name, value in residual.items()),
        (
            "models/test_energy.py::test_every_component_and_the_whole_balance",
            "models/test_energy.py::test_power_crosses_connected_bonds_without_loss",
            "models/test_slider_crank.py::test_power_balances_at_every_instant",
        ),
        short=f"the contact's residual ({residual['contact']} J, {left_out[-1]:+.1e} J after the turn) is no "
        "integration error: Hertz's energy depends on the cam's changing radius of curvature, whose work the "
        f"component does not account for. Computed apart and taken off, {corrected} J are left.",
    )
    yield Row(
        "two independent methods whose difference is the reference's uncertainty",
        "CVODE and DOP853 (Radau where stiff), that run: relative RMS difference "
        f"{found.uncertainty['contact.load'].relative_rms:.0e} in load, "
        f"{found.uncertainty['contact.film_thickness'].relative_rms:.0e} in film",
        (
            "models/test_reference.py::test_two_methods_agree_within_the_tolerance",
            "models/test_reference.py::test_stiff_methods_solve_the_same_problem",
            "models/test_adherence.py::test_two_methods_agree",
        ),
    )
