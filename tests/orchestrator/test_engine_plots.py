"""Figures of an engine: each contact against its own shaft, solved films, the slider between its walls."""

from dataclasses import replace

import numpy as np
import pytest

from orchestrator.plots import film_and_load, slider_crank_motion, slider_crank_phase, solved_film

from .test_plots import FORCE, METRE, NUMBER, RADIAN, build_data


@pytest.fixture
def engine():
    """Four turns of the crank: the slider strikes its upper wall twice, the lower wall is never loaded."""
    time = np.linspace(0.0, 0.12, 401)
    angle = 2.0 * np.pi * time / 0.03
    coupled = {
        "flywheel.angle": (angle, RADIAN),
        "camshaft.cam_angle": (0.5 * angle, RADIAN),
        "slider_crank.piston_offset": (1e-4 * np.sin(angle), METRE),
        "slider_crank.psi": (7e-4 * np.sin(angle), RADIAN),
        "slider_crank.psi_rate": (np.cos(angle), RADIAN),
        "slider_crank.upper_wall_force": (np.zeros(401), FORCE),
        "slider_crank.lower_wall_force": (np.zeros(401), FORCE),
        "slider_crank.impact_count": (1.0 * (time > 0.03) + 2.0 * (time > 0.08), NUMBER),
    }
    for contact, load_size in (("contact", 500.0), ("upper_wall", 300.0), ("lower_wall", 0.0)):
        coupled[f"{contact}.load"] = (load_size * (1.0 + np.cos(angle)), FORCE)
        coupled[f"{contact}.film_thickness"] = (1e-6 * (2.0 + np.cos(angle)), METRE)
    return build_data("engine", time, coupled)


def test_each_component_is_drawn_against_its_own_shaft(engine):
    """The nearest angle upstream: the crank's for the slider and its walls, the cam's for its contact."""
    assert engine.of("slider_crank").abscissa() == ("flywheel.angle", "Crank angle (°)")
    assert engine.of("upper_wall").abscissa() == ("flywheel.angle", "Crank angle (°)")
    assert engine.of("contact").abscissa() == ("camshaft.cam_angle", "Cam angle (°)")
    uneven = engine.coupled["flywheel.angle"] + 0.2 * np.sin(engine.coupled["flywheel.angle"])
    rotating = replace(engine, coupled=engine.coupled | {"flywheel.angle": uneven})
    assert rotating.of("slider_crank").abscissa() == ("flywheel.angle", "Crank angle (°)")
    still = replace(engine, coupled=engine.coupled | {"flywheel.angle": np.zeros(401)})
    assert still.of("slider_crank").abscissa() == ("", "Time (ms)")


def test_contacts_that_carry_no_load_are_left_out(engine):
    assert film_and_load.applies(engine)
    assert film_and_load.find_loaded_contacts(engine) == ["contact", "upper_wall"]
    figure = film_and_load.draw(engine)
    assert [ax.get_xlabel() for ax in figure.axes if ax.get_xlabel()] == ["Cam angle (°)", "Crank angle (°)"]
    assert "".join(ax.get_title(loc="right") for ax in figure.axes) == ""
    film = {"contact.film_thickness": engine.coupled["contact.film_thickness"].copy()}
    film["contact.film_thickness"][3] = 9e-6
    panels = film_and_load.draw(replace(engine, coupled=engine.coupled | film)).axes
    said = "before the last revolution up to 9e-06 m"
    assert said in [ax.get_title(loc="right") for ax in panels]


def test_only_solved_films_are_drawn_and_lost_contact_is_shaded(engine):
    assert not solved_film.applies(engine)
    load = np.maximum(engine.coupled["contact.load"] - 100.0, 0.0)
    own = {
        "contact.load": load,
        "contact.minimum_film_thickness": 0.8 * engine.coupled["contact.film_thickness"],
        "contact.maximum_pressure": 1e6 * load,
        "contact.film_ratio": 5e6 * engine.coupled["contact.film_thickness"],
    }
    given = engine.parameters | {"contact.field_tolerance": 1e-4}
    kinds = engine.quantities | dict.fromkeys(own, NUMBER)
    data = replace(engine, coupled=engine.coupled | own, quantities=kinds, parameters=given)
    assert solved_film.find_solved_contacts(data) == ["contact"]
    figure = solved_film.draw(data)
    shaded = [len(ax.collections) for ax in figure.axes]
    assert shaded == [1, 1, 1, 1]
    (least,) = [line for line in figure.axes[1].lines if line.get_marker() == "o"]
    assert least.get_ydata()[0] == pytest.approx(own["contact.minimum_film_thickness"].min())
    low, high = figure.axes[3].get_ylim()
    assert low < 1.0 < 3.0 < high
    assert [text.get_text() for text in figure.axes[3].texts] == ["film = roughness", "full film above 3"]
    factor, _ = data.shown("contact.load")
    assert figure.axes[0].get_ylim()[1] > 1.05 * factor * load.max()

    hot = {
        "contact.film_temperature": 363.15 + 0.05 * load,
        "contact.surface_temperature": 363.15 + 0.0 * load,
    }
    heated = replace(
        data, coupled=data.coupled | hot, quantities=kinds | dict.fromkeys(hot, NUMBER),
        parameters=data.parameters | {"contact.oil_temperature": 363.15},
    )  # fmt: skip
    panel = solved_film.draw(heated).axes[4]
    words = [text.get_text() for text in panel.get_legend().get_texts()]
    assert words == [f"film, at most {90.0 + 0.05 * load.max():.0f} °C", "surfaces", "entering oil, 90 °C"]
    assert panel.get_ylabel() == "Temperature (°C)"
    assert [float(label.get_text()) for label in panel.get_yticklabels()] == pytest.approx(
        panel.get_yticks() - 273.15
    )


def test_less_than_a_turn_has_angles_on_its_axis(engine):
    few = slice(0, 40)
    time, coupled = engine.time[few], {name: values[few] for name, values in engine.coupled.items()}
    short = replace(engine, time=time, reference_time=time, coupled=coupled, reference=coupled)
    figure = film_and_load.draw(short)
    figure.draw_without_rendering()
    low, high = figure.axes[-1].get_xlim()
    assert sum(low <= tick <= high for tick in figure.axes[-1].get_xticks()) >= 4


def test_walls_are_dashed_at_the_clearance_and_empty_panels_left_out(engine):
    assert slider_crank_motion.applies(engine)
    figure = slider_crank_motion.draw(engine)
    assert [ax.get_ylabel() for ax in figure.axes] == ["Piston offset (m)", "Impacts"]
    walls = [line.get_ydata()[0] for line in figure.axes[0].lines if line.get_linestyle() == "--"]
    assert sorted(walls) == [-1e-4, 1e-4]


def test_the_phase_portrait_is_cut_at_impacts(engine):
    """No line leads from before an impact to after it but the jump's own; every point is drawn."""
    assert slider_crank_phase.applies(engine)
    (axes,) = slider_crank_phase.draw(engine).axes
    (line,) = axes.lines
    drawn = line.get_ydata()
    assert np.isnan(drawn).sum() == 2
    np.testing.assert_array_equal(drawn[~np.isnan(drawn)], engine.coupled["slider_crank.psi_rate"])
    (jumps,) = axes.collections
    assert len(jumps.get_segments()) == 2
