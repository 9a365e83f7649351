"""Asperities under the film, friction of both, and wear."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray

from models.contact.asperities import Asperities, load_integral
from models.contact.fluid import Lubricant
from models.contact.friction import Traction, shear_stress
from models.contact.hertz import elastic_compliance
from models.contact.line.field import FieldContact
from models.contact.line.history import film_history
from models.contact.line.line_contact import LineContact
from models.contact.line.steady import solve_steady
from models.contact.records import ContactParameters
from models.integrator import OK
from tests.models.contact.line.cam_cycle import motion
from tests.models.contact.line.stepped import Contact
from tests.models.test_asperities import cylinder
from tests.models.test_friction import steady

from .line_in_loop import ran
from .shell import tribocosim
from .table import Row

ASPERITIES = "models/test_asperities.py::"
FRICTION = "models/test_friction.py::"
FIELD = "models/test_field_friction.py::"
MIXED = "models/contact/line/test_mixed.py::"
PROMISED = 1e-6
TABULATED = {0.0: 0.616634, 1.0: 0.0805623, 2.0: 5.4237e-3, 3.0: 1.7087e-4}
LOAD, ROUGHNESS = 300.0, 0.8e-6
SURFACES = Asperities(0.2e-6, 0.05, 1e-3)
STILL: dict[str, Any] = {
    "load": LOAD, "radius": 0.02, "length": 0.012, "compliance": elastic_compliance(207e9, 0.3, 207e9, 0.3),
    "lubricant": Lubricant(0.036, 1.8e-8),
}  # fmt: skip
# The film that it starts with has flowed out by this angle (degrees).
STARTED = 120.0
WEAR = "1e-17"


def rows() -> Iterator[Row]:
    yield _integral()
    yield _fits()
    yield _sharing()
    yield _traction()
    yield _in_the_field()
    yield from _cycle()


def _integral() -> Row:
    off = max(abs(load_integral(s) / cylinder(2.5, s) - 1.0) for s in np.linspace(-10.0, 30.0, 401))
    values = ", ".join(f"F({s:g}) = {load_integral(s):.6g} ({v:g})" for s, v in TABULATED.items())
    return Row(
        "Greenwood-Tripp asperity load from an accurate evaluation of its integrals (1e-6)",
        f"F_5/2 from −10 to 30 against parabolic cylinder functions in thirty digits: at most {off:.1e} off; "
        + values,
        (
            ASPERITIES + "test_integrals_are_parabolic_cylinder_functions",
            ASPERITIES + "test_load_integral_has_the_tabulated_values",
            ASPERITIES + "test_pressure_and_area_are_those_of_all_pairs_of_summits",
        ),
        short="" if off <= PROMISED else "not met.",
    )


def _fits() -> Row:
    fit = {s: 4.4086e-5 * (4.0 - s) ** 6.804 / load_integral(s) - 1.0 for s in (0.0, 1.0, 2.0, 3.0)}
    return Row(
        "the usual fits are wrong by 3 to 74 %",
        "4.4086e-5 (4 − λ)^6.804: " + ", ".join(f"{100.0 * v:+.1f} % at {s:g}" for s, v in fit.items()),
        (ASPERITIES + "test_the_usual_fits_of_the_load_integral_are_wrong",),
    )


def _sharing() -> Row:
    shares = {u: steady(LOAD, "moes_venner", u).asperity_load / LOAD for u in (1e-3, 1e-2, 0.1, 1.0)}
    return Row(
        "film-asperity load sharing",
        f"film of Moes, {LOAD:g} N, σ = 0.2 µm, their share at "
        + ", ".join(f"{u:g} m/s {100.0 * share:.3g} %" for u, share in shares.items()),
        (
            FRICTION + "test_film_and_asperities_carry_the_load",
            FRICTION + "test_at_rest_asperities_carry_all_and_under_thick_films_nothing",
        ),
    )


def _traction() -> Row:
    oil = Lubricant(0.036, 1.8e-8)
    newton = Traction(limiting_stress=1e30, limiting_coefficient=0.0)
    laws = {
        "Newtonian": (oil, newton),
        "Eyring, 5 MPa": (oil._replace(eyring_stress=5e6), newton),
        "Newtonian with limiting shear": (oil, Traction()),
    }
    found = {name: shear_stress(5e8, 1.0, 0.2e-6, fluid, limit) for name, (fluid, limit) in laws.items()}
    return Row(
        "traction (Newtonian, Eyring, limiting shear), boundary friction",
        "shear stress at 0.5 GPa, 1 m/s, 0.2 µm: "
        + ", ".join(f"{name} {1e-6 * stress:.3g} MPa" for name, stress in found.items()),
        (
            FRICTION + "test_shear_stress_is_odd_bounded_and_never_above_newtons",
            FRICTION + "test_eyrings_law_is_newtons_at_small_stress_and_its_logarithm_at_large",
            FRICTION + "test_boundary_friction_has_the_shear_of_real_contact_besides",
            FRICTION + "test_stribecks_curve_falls_from_boundary_to_mixed_friction",
        ),
    )


def _in_the_field() -> Row:
    contact = Contact(load_is_given=1.0, roughness=ROUGHNESS)
    running = {"entraining_velocity": 1.0, "radius_of_curvature": 0.02, "sliding_velocity": 1.5}
    made = [contact.step(2e-5, **running, applied_load=LOAD) for _ in range(200)]
    assert all(status == OK for status in made)
    field = contact.component
    assert isinstance(field, FieldContact)
    scale = contact.x[field.state.index("grid_scale")]
    pressure = contact.field("pressure")
    film = float(np.trapezoid(pressure, scale * field.nodes_of(contact.work))) * ContactParameters().length
    asperities = contact["asperity_load"]
    off = abs((film + asperities) / LOAD - 1.0)
    shares = {
        u: solve_steady(LineContact(**STILL, velocity=u, asperities=SURFACES)).asperity_load / LOAD
        for u in (1e-3, 1e-2, 0.1, 1.0)
    }
    degrees = np.linspace(95.0, 225.0, 261)
    m = motion(degrees, 1000.0)
    cam = film_history(m.times, m.load, m.velocity, m.radius, 301, {"roughness": SURFACES.roughness})
    share, event = cam.asperity_load / cam.load, degrees[1:] > STARTED
    nose = int(np.argmin(np.abs(degrees[1:] - 180.0)))
    most = int(np.argmax(np.where(event, share, 0.0)))
    return Row(
        "load sharing in the solved film (`line_transient`)",
        f"{LOAD:g} N, σ = {1e6 * ROUGHNESS:g} µm: oil carries {film:.2f} N, asperities {asperities:.2f} N, "
        f"together {LOAD:g} N to {off:.0e}; friction of the film {contact['viscous_friction']:.2f} N, of "
        f"asperities {contact['boundary_friction']:.2f} N; steady, σ = 0.2 µm, their share at "
        + ", ".join(f"{u:g} m/s {100.0 * found:.3g} %" for u, found in shares.items())
        + f"; in the cam's event at 1000 r/min at most {100.0 * share[most]:.2g} % at "
        f"{degrees[most + 1] - 180.0:+.1f}°, {100.0 * share[nose]:.2g} % at the nose; "
        f"least film {1e6 * cam.minimum_film_thickness[event].min():.4f} µm",
        (
            MIXED + "test_the_pressures_of_oil_and_asperities_carry_the_load",
            MIXED + "test_a_dense_solution_has_the_same_film",
            MIXED + "test_asperities_carry_all_as_entrainment_ends",
            MIXED + "test_without_oil_to_speak_of_it_is_the_dry_contact_of_rough_bodies",
            MIXED + "test_the_jacobian_by_total_pressure_is_its_differences",
            MIXED + "test_a_mixed_film_is_of_order_two_in_time",
            MIXED + "test_load_and_friction_are_counted_once",
            FIELD + "test_friction_is_odd_in_the_sliding_and_that_of_asperities_coulombs",
        ),
        short="" if off <= PROMISED else "oil and asperities do not carry the load together.",
    )


def _cycle() -> Iterator[Row]:
    folder, _ = ran("valve-train-ehl")
    table = folder / "friction.nc"
    said = tribocosim("friction", str(folder), "--table", str(table), "--wear-coefficient", WEAR)
    assert said.status == 0, said
    data = xarray.load_dataset(table)
    yield Row(
        "friction torque on the camshaft, friction power and mean friction over the cycle",
        f"`valve-train-ehl`: mean torque {data['mean_torque'].item():.3f} N m (largest "
        f"{data['largest_torque'].item():.3f}), mean power {data['mean_power'].item():.1f} W, coefficient "
        f"{data['coefficient'].item():.4f}, {100.0 * data['boundary_share'].item():.1f} % of the work by "
        f"asperities, least film ratio {data['least_film_ratio'].item():.2f}",
        (
            "orchestrator/test_friction.py::test_torque_and_work_are_closed_forms",
            "orchestrator/test_friction.py::test_the_command_says_what_the_table_holds",
        ),
        command="tribocosim friction FOLDER --table friction.nc",
    )
    yield Row(
        "wear depth by Archard along the cam and tappet",
        f"k = {WEAR} m²/N: deepest in one revolution {data['cam_wear'].max().item():.2g} m on the cam, "
        f"{data['follower_wear'].max().item():.2g} m on the follower, at "
        f"{1e3 * data['follower_place'][int(np.argmax(data['follower_wear'].values))].item():.2f} mm",
        (
            "orchestrator/test_friction.py::test_both_bodies_lose_the_volume_of_archards_law",
            "models/test_wear.py::test_a_steady_pass_wears_load_over_length_times_the_ratio_of_speeds",
        ),
        command="tribocosim friction FOLDER --figure friction.png",
    )
