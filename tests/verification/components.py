"""What each component has, by the test that shows it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from models.catalogue import CATALOGUE

from .table import Row, outcomes

FEATURES: tuple[tuple[str, tuple[str, ...]], ...] = (
    (
        "camshaft: cycloidal cam with nose dwell, flat-follower kinematics",
        (
            "test_kinematics.py::test_base_circle_and_nose_dwell",
            "test_kinematics.py::test_camshaft_outputs_are_the_kinematics",
        ),
    ),
    (
        "camshaft: torsional and bending flexibility (K 33, two nodes), can be switched to rigid",
        (
            "test_camshaft.py::test_first_bending_and_torsion_frequencies",
            "test_camshaft.py::test_static_deflection_is_that_of_a_cantilever",
            "test_camshaft.py::test_torsion_is_that_of_a_rod",
            "test_camshaft.py::test_wind_up_adds_to_the_cams_angle_and_speed",
        ),
    ),
    (
        "valve_spring: N coil masses, preload, damping",
        ("test_spring.py::test_clamped_frequencies_of_more_masses", "test_spring.py::test_static_rate_is_k0"),
    ),
    (
        "valve_spring: lash and unilateral valve seat",
        (
            "test_valve.py::test_lash_keeps_the_valve_closed_until_the_cam_has_taken_it_up",
            "test_valve.py::test_seat_never_pulls",
            "test_valve.py::test_valve_bounces_on_its_seat_and_loses_energy_each_time",
        ),
    ),
    (
        "ehl_contact: film by K (10) as the relaxation equation",
        (
            "test_films.py::test_relaxation_time_constant_is_c_h_over_u",
            "test_films.py::test_relaxation_agrees_with_the_exact_implicit_step",
            "test_films.py::test_film_is_kept_where_the_entraining_velocity_vanishes",
        ),
    ),
    (
        "ehl_contact: the other film formulas as a parameter",
        (
            "test_films.py::test_exponents_are_those_printed",
            "test_films.py::test_moes_fit_is_near_numerical_solutions",
            "test_films.py::test_power_laws_of_two_groups",
        ),
    ),
    (
        "ehl_contact: squeeze velocity, pressure, half width, validity flags of Table 3",
        (
            "test_films.py::test_range_flags_of_kushwahas_table_3",
            "test_hertz.py::test_pressure_carries_the_load_and_obeys_the_width_law",
        ),
    ),
    (
        "ehl_contact: mixed lubrication, friction and wear",
        (
            "test_asperities.py::test_integrals_are_parabolic_cylinder_functions",
            "test_asperities.py::test_pressure_and_area_are_those_of_all_pairs_of_summits",
            "test_friction.py::test_film_and_asperities_carry_the_load",
            "test_friction.py::test_friction_of_a_constant_viscosity_is_a_closed_form",
            "test_field_friction.py::test_a_film_at_its_limiting_stress_rubs_by_the_pressure_it_carries",
            "test_wear.py::test_a_steady_pass_wears_load_over_length_times_the_ratio_of_speeds",
        ),
    ),
    (
        "ehl_contact: approach in, load and film out; adherence form, load in, film out",
        (
            "test_hertz.py::test_no_load_without_overlap",
            "test_hertz.py::test_load_never_pulls_however_fast_the_surfaces_part",
            "test_valve.py::test_contact_is_lost_and_regained_at_3400_rpm",
        ),
    ),
    (
        "slider_crank: F's equations `as_published` and `corrected`",
        (
            "test_slider_crank_equations.py::test_constant_speed_form_is_f_2_13",
            "test_slider_crank_equations.py::test_motion_and_torque_agree_with_lagrange_to_first_order",
            "test_slider_crank_equations.py::test_published_form_is_not_the_mechanism",
        ),
    ),
    (
        "slider_crank: walls, impact with restitution, sliding and release, exact event times",
        (
            "test_slider_crank_equations.py::test_impact_is_f_2_17",
            "test_slider_crank.py::test_walls_are_never_passed_and_only_push",
            "test_slider_crank.py::test_cutting_time_changes_no_impact",
            "test_hybrid.py::test_one_impact_orbit_of_the_harmonic_oscillator",
            "test_hybrid.py::test_grazing_inside_one_step_is_not_missed",
        ),
    ),
    (
        "slider_crank: takes wall film thickness",
        (
            "test_slider_crank.py::test_film_narrows_the_clearance_and_moves_the_wall",
            "test_slider_crank.py::test_film_that_grows_into_a_bounce_is_an_approaching_wall",
            "test_slider_crank_films.py::test_bounces_on_moving_walls_end_in_sliding_and_pass_no_wall",
            "test_slider_crank_films.py::test_energy_closes_from_one_wall_to_the_other",
        ),
    ),
    (
        "flywheel: inertia, drive and load torques, prescribed speed (constant, ramp, run-up from rest)",
        (
            "test_flywheel.py::test_free_motion_under_constant_torques",
            "test_flywheel.py::test_prescribed_ramp",
            "test_flywheel.py::test_loads_add_up",
        ),
    ),
)

MONOLITHIC: tuple[tuple[str, tuple[str, ...]], ...] = (
    (
        "kernels that numba compiles and plain Python runs",
        ("test_plain_python.py::test_plain_python_equals_compiled_code",),
    ),
    (
        "monolithic: any System as one problem, without splitting, events located",
        (
            "test_system.py::test_algebraic_loop_of_free_flywheel_and_rigid_camshaft",
            "test_reference.py::test_events_are_located_to_the_tolerance",
            "test_reference.py::test_simultaneous_events_all_happen",
        ),
    ),
    (
        "monolithic: the constrained adherence model of K, as a check",
        ("test_adherence.py::test_massless_load_is_the_closed_form",),
    ),
)

SHORT = {
    "ehl_contact: approach in, load and film out; adherence form, load in, film "
    "out": "in the valve train the "
    "film comes back into the deflection inside this FMU; from FMU to FMU it goes only in `engine`.",
    "ehl_contact: mixed lubrication, friction and wear": "no shipped scenario connects the friction "
    "to the camshaft's `friction_force`.",
}


def rows() -> Iterator[Row]:
    for name, make in CATALOGUE.items():
        component = make()
        yield Row(
            f"{name}: typed parameters, states, inputs, outputs, units, checks, stored energy",
            f"takes {', '.join(component.inputs.names)}; gives {', '.join(component.outputs.names)}",
            ("fmus/test_description.py::test_every_quantity_is_described",),
        )
    features = [
        Row(promise, "", tuple(f"models/{test}" for test in tests), short=SHORT.get(promise, ""))
        for promise, tests in FEATURES + MONOLITHIC
    ]
    found = outcomes(features)
    for row in features:
        results = [found.get(test, "did not run") for test in row.tests]
        failed = any("failed" in r or "error" in r or "not" in r for r in results)
        yield replace(
            row,
            value="cases: " + "; ".join(results),
            short=row.short + (" Tests fail." if failed else ""),
        )
