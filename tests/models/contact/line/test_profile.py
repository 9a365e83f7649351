"""Profiles across a contact: they carry its load, and have its extremes."""

import numpy as np
import pytest

from models.contact.line.profile import read_profiles

from .stepped import Contact


@pytest.mark.parametrize("roughness", [0.0, 2e-7])
def test_the_profile_carries_the_load_and_has_the_extremes(roughness: float) -> None:
    """The pressure, linear between nodes as the model has it, integrates to the load to rounding.

    Extremes of outputs are those of parabolas through three nodes, at or beyond the nodes' own (measured:
    2.4 % beyond).
    """
    contact = Contact(roughness=roughness)
    states = [contact.x.copy()]
    for _ in range(5):
        contact.step(2e-5, approach=4e-6, entraining_velocity=lambda t: 1.0 + 100.0 * t, sliding_velocity=0.5)
        states.append(contact.x.copy())
    found = read_profiles(contact.component, contact.p, np.array(states))
    assert not np.any(found.pressure[0]), "the field begins with the first step"
    length = contact.p[contact.component.parameters.index("length")]
    load = np.trapezoid(found.pressure[-1], found.position[-1]) * length
    assert load == pytest.approx(contact["load"], rel=1e-12)
    highest, least = np.max(found.pressure[-1]), np.min(found.film[-1])
    assert highest <= contact["maximum_pressure"] < 1.05 * highest
    assert 0.95 * least < contact["minimum_film_thickness"] <= least
