"""Friction of the contact whose film is solved for: of its own profiles."""

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.contact.films import FILMS
from models.core.component import Component

from .stepped import Stepped

GIVEN = {"load_is_given": 1.0}
LOAD = 300.0


@pytest.fixture(scope="module")
def contact() -> Component:
    return CATALOGUE["ehl_line_contact"](nodes=101)


def settled(
    contact: Component, sliding: float, load: float = LOAD, entraining: float = 2.0, **parameters: float
) -> dict[str, float]:
    """Outputs after 1 ms of a constant load, in which the film passes the contact at least once."""
    inputs = {"applied_load": load, "entraining_velocity": entraining, "sliding_velocity": sliding}
    stepped = Stepped(contact, {**GIVEN, **parameters}, inputs=inputs)
    for _ in range(10):
        stepped.advance(1e-4)
    return contact.outputs.named(stepped.y)


def test_a_film_at_its_limiting_stress_rubs_by_the_pressure_it_carries(contact):
    """gamma W, whatever the pressure's shape."""
    out = settled(contact, 1e7, limiting_shear_stress=0.0, limiting_shear_coefficient=0.05)
    assert out["load"] == pytest.approx(LOAD, rel=1e-3)
    # The trapezoidal rule of the friction against the field's own weights: h^2 of 101 nodes.
    assert out["viscous_friction"] == pytest.approx(0.05 * out["load"], rel=2e-3)


def test_friction_is_odd_in_the_sliding_and_that_of_asperities_coulombs(contact):
    one, other = (settled(contact, slide, roughness=0.8e-6) for slide in (1.5, -1.5))
    for name in ("viscous_friction", "boundary_friction", "friction_force"):
        assert one[name] == pytest.approx(-other[name], rel=1e-12)
        assert one[name] > 0.0
    assert one["asperity_load"] > 0.0
    assert one["boundary_friction"] == pytest.approx(0.1 * one["asperity_load"], rel=1e-12)
    assert one["friction_force"] == one["viscous_friction"] + one["boundary_friction"]
    assert one["film_ratio"] == pytest.approx(one["film_thickness"] / 0.8e-6, rel=1e-12)


def test_friction_of_a_heavy_contact_is_near_that_of_the_formula_with_its_film(contact):
    """M = 25: Hertz's pressure over the central film against the solved profiles."""
    drives = {"load": 3000.0, "entraining": 0.3}
    solved = settled(contact, 0.1, **drives)
    plain = CATALOGUE["ehl_contact"]()
    p = plain.parameters.vector({**GIVEN, "film_model": float(list(FILMS).index("moes_venner"))})
    u = plain.inputs.vector({"applied_load": 3000.0, "entraining_velocity": 0.3, "sliding_velocity": 0.1})
    y = np.zeros(plain.outputs.size)
    plain.flat_output(0.0, np.array([solved["film_thickness"]]), u, p, y)
    # What is left is the inlet's and the constriction's shear and the pressure's departure from Hertz's.
    assert plain.outputs.named(y)["viscous_friction"] == pytest.approx(solved["viscous_friction"], rel=0.15)
