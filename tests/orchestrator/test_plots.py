"""Figures of a run: what they leave out, what they are drawn against, where their lines are cut."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
import xarray

from models.core.quantities import Quantity, Vector
from models.core.system import System
from orchestrator.assessment.diagnosis import Steps
from orchestrator.assessment.lost_contact import LIGHT
from orchestrator.plots import (
    difference,
    film_and_load,
    journal_orbits,
    solution,
    steps,
    valve_train,
    valves,
)  # fmt: skip
from orchestrator.plots.data import FigureData
from orchestrator.plots.speeds import draw_campbell, draw_map
from orchestrator.scenario import parse_ends
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, list_parameters

METRE, RADIAN, FORCE, NUMBER = (Quantity(unit, unit) for unit in ("m", "rad", "N", "1"))


def build_data(name: str, time: Vector, coupled: dict[str, tuple[Vector, Quantity]]) -> FigureData:
    """A run of a shipped scenario that agrees with its reference."""
    scenario = load(name)
    values = {variable: value for variable, (value, _) in coupled.items()}
    return FigureData(
        title=name, time=time, coupled=values, reference_time=time, reference=values,
        quantities={variable: quantity for variable, (_, quantity) in coupled.items()},
        drivers={target: source for source, target in map(parse_ends, scenario.connections)},
        parameters=list_parameters(scenario), system=build_system(scenario), tolerance=scenario.tolerance,
    )  # fmt: skip


@pytest.mark.parametrize("records", [10, 800, 801, 5934])
def test_the_envelope_of_errors_leaves_no_record_out(records):
    """A record that is larger than all before it is the largest of its bin, the last record too."""
    first, top = difference.compute_envelope(np.arange(1.0, records + 1.0))
    assert (first[0], top[-1]) == (0, records)
    np.testing.assert_array_equal(top, np.append(first[1:], records))


def test_drawing_leaves_pyplot_alone(tmp_path):
    """A notebook that draws a run keeps its backend and gets no figure of ours."""
    alone = (
        "import sys, orchestrator.plots.style as style; from pathlib import Path;"
        "style.save_figure(lambda: style.create_subplots(2)[0], Path(sys.argv[1]));"
        "assert 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", alone, str(tmp_path / "figure.svg")], check=True)
    assert (tmp_path / "figure.svg").stat().st_size > 1000


@pytest.fixture
def bouncing():
    """A valve train whose follower is 20 um off its cam over the nose, where the load is 0."""
    time = np.linspace(0.0, 60.0 / 3400.0, 721)
    angle = 2.0 * np.pi * time / time[-1]
    nose = np.abs(angle - np.pi) < 0.3
    cam = 4e-3 * (1.0 - np.cos(angle))
    coupled = {
        "flywheel.angle": (angle, RADIAN),
        "flywheel.speed": (np.full_like(time, 356.0), RADIAN),
        "camshaft.cam_angle": (angle, RADIAN),
        "camshaft.surface_position": (cam, METRE),
        "camshaft.cam_lift": (cam, METRE),
        "camshaft.entraining_velocity": (np.cos(angle), METRE),
        "camshaft.sliding_velocity": (np.cos(angle), METRE),
        "camshaft.drive_torque": (np.sin(angle), FORCE),
        "valve_spring.position": (cam + 20e-6 * nose, METRE),
        "valve_spring.valve_lift": (cam + 20e-6 * nose, METRE),
        "valve_spring.seat_dip": (np.zeros_like(time), METRE),
        "valve_spring.velocity": (np.sin(angle), METRE),
        "valve_spring.acceleration": (np.cos(angle), METRE),
        "valve_spring.spring_force": (300.0 + cam, FORCE),
        "contact.load": (np.where(nose, 0.0, 400.0), FORCE),
        "contact.maximum_pressure": (np.where(nose, 0.0, 3e8), FORCE),
        "contact.film_thickness": (1e-6 * (2.0 + np.cos(angle)), METRE),
        "contact.film_ratio": (2.0 + np.cos(angle), NUMBER),
        "contact.friction_force": (np.where(nose, 0.0, 20.0), FORCE),
    }
    return build_data("valve-train-bounce", time, coupled)


def test_a_bouncing_valve_shows_its_gap_and_no_film(bouncing):
    figure = valve_train.draw(bouncing)
    panels = {ax.get_ylabel().split(" (")[0]: ax for ax in figure.axes if ax.get_visible()}
    lines = {words: ax.lines[1].get_ydata() for words, ax in panels.items()}  # over the reference
    assert set(valve_train.CONTACT) | {"Velocity", "Acceleration", "Spring force", "Cam torque"} < set(lines)
    apart = bouncing.lost("contact")
    assert lines["Gap"].max() == pytest.approx(20.0)
    assert not lines["Gap"][~apart].any()
    beside_load = film_and_load.draw(bouncing).axes[2].lines[-1].get_ydata()
    for film in (lines["Film thickness"], lines["Film ratio"], beside_load):
        np.testing.assert_array_equal(np.isnan(film), apart)
    assert all(ax.collections for ax in figure.axes if ax.get_visible())  # shaded
    assert {ax.get_xlabel() for ax in figure.axes if ax.get_xlabel()} == {"Cam angle (°)"}


def test_a_film_ratio_under_next_to_no_load_is_not_drawn(bouncing):
    """There asperities alone hold the surfaces apart, and the ratio grows as the load goes to zero."""
    load = bouncing.coupled["contact.load"].copy()
    load[:3] = [0.0, 0.5 * LIGHT * 400.0, 2.0 * LIGHT * 400.0]
    own = replace(bouncing, coupled={**bouncing.coupled, "contact.load": load}).in_contact("contact")
    assert np.isnan(own.coupled["contact.film_ratio"][:3]).tolist() == [True, True, False]
    assert np.isnan(own.coupled["contact.film_thickness"][:3]).tolist() == [True, False, False]


def test_what_lash_opens_on_the_base_circle_is_not_shaded():
    """A cam of 8.3 mm, with a seat: contact is lost over the nose only."""
    time = np.linspace(0.0, 1.0, 501)
    lift, nose = 8.3e-3 * np.maximum(0.0, np.sin(2.0 * np.pi * time)), np.abs(time - 0.25) < 0.02
    load_ = np.where((lift < 0.2e-3) | nose, 0.0, 500.0)
    columns = {"camshaft.cam_lift": (lift, METRE), "contact.load": (load_, FORCE)}
    data = build_data("seat-and-lash", time, columns)
    np.testing.assert_array_equal(data.lost("contact"), nose)
    np.testing.assert_array_equal(data.opened("contact"), load_ == 0.0)


def test_friction_at_rest_is_not_drawn(bouncing):
    """There its sign is that of vibrations; without load it is zero."""
    sliding = bouncing.coupled["camshaft.sliding_velocity"].copy()
    nose = int(np.flatnonzero(bouncing.lost("contact"))[0])
    sliding[[0, 1, nose]] = 1e-6, -1e-6, 1e-6
    own = replace(bouncing, coupled={**bouncing.coupled, "camshaft.sliding_velocity": sliding})
    friction = own.in_contact("contact").coupled["contact.friction_force"]
    assert np.isnan(friction[:3]).tolist() == [True, True, False]
    assert friction[nose] == 0.0


def test_films_are_scaled_by_the_last_turn(long):
    """Not by the film of the start, which the scenario gives: here a hundred times as thick."""
    film = long.coupled["contact.film_thickness"] * np.where(long.time < 0.001, 100.0, 1.0)
    figure = film_and_load.draw(replace(long, coupled={**long.coupled, "contact.film_thickness": film}))
    assert figure.axes[2].get_ylim()[1] == pytest.approx(1.1 * 3e-6)


def test_the_kinematic_motion_is_the_cams_lift_and_its_derivatives(bouncing):
    """s = 4 mm (1 - cos wt): v = 4 mm w sin wt, a = 4 mm w^2 cos wt; the spline is off by less than 1e-3."""
    figure = valve_train.draw(bouncing)
    omega = 2.0 * np.pi / bouncing.time[-1]
    right = {"Velocity": 4e-3 * omega * np.sin(omega * bouncing.time)}
    right["Acceleration"] = 4e-3 * omega**2 * np.cos(omega * bouncing.time)
    for ax in figure.axes:
        for line in ax.lines:
            words = ax.get_ylabel().split(" (")[0]
            if line.get_label() == "kinematic (rigid, no lash)" and words in right:
                size = np.abs(right[words]).max()
                np.testing.assert_allclose(line.get_ydata(), right.pop(words), atol=1e-3 * size)
    assert not right


def test_a_valve_that_stays_on_its_cam_has_no_gap(bouncing):
    loaded = bouncing.coupled | {"contact.load": np.full_like(bouncing.time, 400.0)}
    without_gap = replace(bouncing, coupled=loaded, reference=loaded)
    assert "Gap (µm)" not in [ax.get_ylabel() for ax in valve_train.draw(without_gap).axes]


@pytest.fixture
def long(bouncing):
    """Two and a half turns."""

    def repeat(values, step=0.0):
        return np.concatenate([values[:-1] + i * step for i in range(3)])[: 5 * (len(values) - 1) // 2]

    turning = {"flywheel.angle": 2.0 * np.pi, "camshaft.cam_angle": 2.0 * np.pi}
    coupled = {name: repeat(values, turning.get(name, 0.0)) for name, values in bouncing.coupled.items()}
    time = repeat(bouncing.time, float(bouncing.time[-1]))
    return replace(bouncing, time=time, coupled=coupled, reference_time=time, reference=coupled)


def test_the_last_whole_revolution_is_drawn_from_zero(bouncing, long):
    own, which = valve_train.prepare(long, long.trains[0])
    assert which == "revolution 2 of 2"
    assert own.x()[[0, -1]] == pytest.approx([0.0, 360.0], abs=0.51)
    np.testing.assert_array_equal(own.coupled["contact.load"][:720], bouncing.coupled["contact.load"][:720])
    remarks = [ax.get_title(loc="right") for ax in valve_train.draw(long).axes]
    (margin,) = [text for text in remarks if text.startswith("spring margin")]
    assert margin.endswith("° in revolution 2")


def test_a_friction_of_nothing_but_rounding_is_drawn_as_zero(bouncing):
    tiny = bouncing.coupled | {"contact.friction_force": 1e-17 * np.sin(np.arange(721.0))}
    figure = valve_train.draw(replace(bouncing, coupled=tiny, reference=tiny))
    (friction,) = [ax for ax in figure.axes if ax.get_ylabel().startswith("Friction")]
    assert friction.get_ylim() == pytest.approx((-1.1, 1.1))


def test_over_the_crank_a_revolution_of_the_cam_has_720_degrees(long):
    cam, crank = (valve_train.prepare(data, long.trains[0])[0] for data in (long, long.over("crank_angle")))
    np.testing.assert_allclose(crank.x(), 2.0 * cam.x(), rtol=1e-12)
    np.testing.assert_array_equal(crank.coupled["contact.load"], cam.coupled["contact.load"])
    bottom = valve_train.draw(long.over("crank_angle")).axes[-1]
    assert (bottom.get_xlabel(), bottom.get_xlim()) == ("Crank angle (°)", (0.0, 720.0))


def test_many_valves_are_all_drawn_and_named(bouncing):
    """A copy of the train under other names, of half the load."""
    assert bouncing.system
    parts = ("camshaft", "valve_spring", "contact")

    def rename(name):
        instance, variable = name.split(".")
        return f"{instance}_b.{variable}" if instance in parts else name

    def copy(values):
        return {rename(n): 0.5 * v for n, v in values.items() if not n.startswith("flywheel")}

    instances = {**bouncing.system.instances, **{f"{n}_b": bouncing.system.instances[n] for n in parts}}
    lines = [(str(c.source), str(c.target)) for c in bouncing.system.connections]
    twins = [(rename(s), rename(t)) for s, t in lines if not t.startswith("flywheel")]
    both = replace(
        bouncing,
        coupled={**bouncing.coupled, **copy(dict(bouncing.coupled))},
        reference={},
        quantities={**bouncing.quantities, **{rename(n): q for n, q in bouncing.quantities.items()}},
        drivers={target: source for source, target in lines + twins},
        system=System(instances, lines + twins),
    )
    assert [train.cam for train in both.trains] == ["camshaft", "camshaft_b"]
    assert valves.applies(both)
    assert not valves.applies(bouncing)
    panels = [ax for ax in valves.draw(both).axes if ax.get_visible()]
    assert [ax.get_title(loc="left") for ax in panels] == ["contact", "contact_b"]
    pushed = replace(both, drivers={t: s for t, s in both.drivers.items() if not t.endswith(".retreat")})
    for ax in valves.draw(pushed).axes:  # whatever moves the contact's other side, its valve's lift is drawn
        assert ax.collections[0].get_paths()[0].get_extents().y1 == pytest.approx(0.35 * ax.get_ylim()[1])
    assert panels[0].get_xlabel() == "Cam angle (°)"
    kept = {name: values + name.endswith(".load") for name, values in both.coupled.items()}
    for data, lost in ((both, True), (replace(both, coupled=kept), False)):
        assert ("lost" in valves.draw(data).get_suptitle()) == lost
    load = next(ax for ax in valve_train.draw(both).axes if ax.get_ylabel().startswith("Load"))
    assert [max(line.get_ydata()) for line in load.lines[:2]] == [200.0, 400.0]  # pale below


def test_each_judged_variable_has_its_error_and_its_tolerance_in_a_panel(bouncing):
    off = {"contact.load": bouncing.coupled["contact.load"] + 0.2}
    off["contact.film_thickness"] = np.nextafter(bouncing.coupled["contact.film_thickness"], 1.0)
    one = difference.draw(replace(bouncing, coupled=bouncing.coupled | off))
    assert len(one.axes) == 1  # no panel for a variable without an error above rounding
    off["contact.film_thickness"] = bouncing.coupled["contact.film_thickness"] * 1.01
    off["camshaft.cam_angle"] = 0.9999 * bouncing.coupled["camshaft.cam_angle"]  # of a soft shaft
    figure = difference.draw(replace(bouncing, coupled=bouncing.coupled | off))
    assert figure.axes[0].get_xlim() == (0.0, 360.0)
    assert [ax.get_title(loc="left") for ax in figure.axes] == ["contact.load", "contact.film_thickness"]
    error, allowed = figure.axes[0].lines
    spread = np.std(bouncing.reference["contact.load"])  # records at equal distances
    assert error.get_ydata() == pytest.approx(0.2 / spread)
    assert allowed.get_ydata()[0] == 1e-3
    film, lost = figure.axes[1].lines[0].get_ydata(), bouncing.lost("contact")
    assert lost.any()
    assert np.array_equal(np.isnan(film), lost)  # where contact is lost there is none


def test_what_no_other_figure_draws_is_drawn_by_variable(bouncing):
    time = np.linspace(0.0, 1.0, 11)
    names = ("chassis.position", "wheel.position", "wheel.velocity", "wheel.tyre_force", "wheel.still")
    coupled = {name: np.sin((i + 1) * time) for i, name in enumerate(names)} | {"wheel.still": np.ones(11)}
    data = FigureData(
        title="car", time=time, coupled=coupled, reference_time=time, reference={},
        quantities=dict.fromkeys(coupled, METRE), drivers={"chassis.wheel_velocity": "wheel.velocity"},
        tolerance={"chassis.position": 1e-3, "wheel.position": 1e-3},
    )  # fmt: skip
    assert solution.choose_panels(data) == {
        "position": ["chassis.position", "wheel.position"],
        "velocity": ["wheel.velocity"],
    }
    alone = replace(data, drivers={}, tolerance={})
    bare = replace(alone, quantities=dict.fromkeys(coupled, Quantity("", "of an FMU that states no unit")))
    assert [ax.get_ylabel() for ax in solution.draw(bare).axes] == ["position", "velocity", "tyre_force"]
    assert set(solution.choose_panels(alone)) == {"position", "velocity", "tyre_force"}
    assert [ax.get_ylabel() for ax in solution.draw(data).axes] == ["position (m)", "velocity (m)"]
    one = replace(data, tolerance={"wheel.position": 1e-3}, drivers={"wheel.road": "chassis.position"})
    (legend,) = (ax.get_legend() for ax in solution.draw(one).axes)
    assert [text.get_text() for text in legend.get_texts()] == ["chassis", "wheel"]  # in the scenario's order
    assert not solution.applies(bouncing)  # at a constant speed


def macro_steps(iterations: list[int]) -> Steps:
    count = len(iterations)
    even = np.full(count, 0.1)
    nothing = np.zeros(count)
    return Steps(np.cumsum(even), even, np.array(iterations), *[nothing] * 5)


def test_steps_that_are_all_alike_but_the_first_are_not_drawn(bouncing):
    """The first of Gauss-Seidel's have two iterations, while its polynomials gather their past."""
    assert not steps.applies(replace(bouncing, steps=macro_steps([2, 2, 1, 1, 1, 1])))
    assert steps.applies(replace(bouncing, steps=macro_steps([2, 2, 1, 1, 2, 1])))


def test_orbits_are_in_parts_of_the_clearance():
    """A circle of 10 um in a clearance of 25 um has the radius 0.4; a journal in the middle is at 0."""
    time = np.linspace(0.0, 0.12, 101)
    x, y = 1e-5 * np.cos(100.0 * time), 1e-5 * np.sin(100.0 * time)
    x[0] = y[0] = 0.0
    columns = {"x": x, "y": y, "ratio": np.hypot(x, y) / 25e-6}
    coupled = {f"bearing_1.eccentricity_{end}": (values, METRE) for end, values in columns.items()}
    coupled["bearing_1.minimum_film_thickness"] = (25e-6 - np.hypot(x, y), METRE)
    force = {"force_x": -30.0 * time, "force_y": 40.0 * time, "load": 50.0 * time}
    coupled |= {f"bearing_1.{name}": (values, FORCE) for name, values in force.items()}
    data = build_data("shaft-in-bearings", time, coupled)
    orbit = np.hypot(*journal_orbits.find_orbit(data, "bearing_1"))
    assert orbit[0] == 0.0
    assert orbit[1:] == pytest.approx(0.4)
    assert journal_orbits.applies(data)
    figure = journal_orbits.draw(data)
    above, magnified, _ = figure.axes
    assert magnified.get_xlim() == pytest.approx((-0.48, 0.48), abs=1e-3)  # 1.2 times the orbit
    assert above.get_title(loc="right").startswith("largest load 6 N")
    assert above.lines[-1].get_xydata()[1] == pytest.approx([0.6, -0.8])  # on the bush
    assert [ax.get_title(loc="left") for ax in (magnified, above)] == ["enlarged", "bearing 1"]
    assert [sum(line.get_label() == "bush" for line in ax.lines) for ax in (above, magnified)] == [1, 0]
    figure.draw_without_rendering()
    left, right = ([getattr(ax.bbox, end) for ax in figure.axes] for end in ("x0", "x1"))
    assert max(np.ptp(left), np.ptp(right)) < 1.0, "panels of a column stand in line"  # pixels
    labels = {text.get_text() for text in figure.legends[0].get_texts()}
    assert labels >= {"coupled", "bush", "start"}
    given = {"film_model": 2.0, "groove_angle": np.radians(30.0), "groove_width": np.radians(20.0)}
    own = data.parameters | {f"bearing_1.{name}": value for name, value in given.items()}
    drawn = journal_orbits.draw(replace(data, parameters=own)).axes[0].lines
    grooves = [line.get_xydata()[[0, -1]] for line in drawn if line.get_label() == "groove"]
    ends = [np.degrees(np.arctan2(arc[:, 1], arc[:, 0])) % 360.0 for arc in grooves]
    np.testing.assert_allclose(ends, [(20.0, 40.0), (200.0, 220.0)])
    hidden = {"pin.eccentricity_ratio": coupled["bearing_1.eccentricity_ratio"]}
    assert not journal_orbits.applies(build_data("roller-friction", time, hidden)), "the place is not shown"


def test_a_contact_that_nothing_closes_has_figures_over_speed(tmp_path):
    turn = np.broadcast_to(np.linspace(0.0, 2.0 * np.pi, 73), (2, 73))
    columns = {"cam_angle": turn, "contact.load": 0.0 * turn}
    cycles = xarray.Dataset({name: (("speed", "share"), one) for name, one in columns.items()})
    cycles = cycles.assign_coords(speed=[80.0, 100.0]).assign_attrs(cam_ratio=1.0)
    for figure in (
        draw_map(cycles, "contact.load", np.zeros(2, bool)),
        draw_campbell(cycles, "contact.load"),
    ):
        figure.savefig(tmp_path / "one.png")
