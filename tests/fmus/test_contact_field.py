"""The FMU of the contact as it is built without further ado: its film is solved for if the user wants it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from models.contact.films import FILMS

from .instance import Instance
from .reference import Reference, wave

STEP = 1e-5
# Rough enough for asperities to carry a part.
SOLVED = {"film_model": float(list(FILMS).index("line_transient")), "roughness": 0.5e-6}
MOVING = {
    "approach": 0.3e-6,
    "approach_der1": 1e-4,
    "entraining_velocity": 2.0,
    "entraining_velocity_der1": -1e3,
    "sliding_velocity": 1.0,
    "radius_of_curvature": 0.02,
}


def at(t: float) -> dict[str, float]:
    """The inputs on their straight lines."""
    return {
        name: value + t * MOVING.get(f"{name}_der1", 0.0) if "_der" not in name else value
        for name, value in MOVING.items()
    }


@pytest.fixture(scope="module")
def slave(fmu_files: dict[str, Path]) -> Iterator[Instance]:
    made = Instance(fmu_files["ehl_contact"])
    made.initialize(**SOLVED, **at(0.0))
    yield made
    made.free()


def onwards(slave: Instance, first: int, last: int) -> list[list[float]]:
    found = []
    for k in range(first, last):
        slave.set(at(k * STEP))
        slave.step(k * STEP, STEP)
        found.append(slave.outputs())
    return found


def test_a_solved_film_in_the_fmu_its_rates_and_its_saved_states_to_the_last_bit(slave: Instance) -> None:
    own = Reference("ehl_contact")
    for name, value in SOLVED.items():
        own.p[own.component.parameters.index(name)] = value
    for k, found in enumerate(onwards(slave, 0, 10)):
        own.set_inputs(at(k * STEP))
        own.step(STEP)
        assert found == own.outputs()
    data, state = slave.saved_bytes(), slave.save()
    first = onwards(slave, 10, 15)
    slave.restore(state)
    assert onwards(slave, 10, 15) == first
    slave.restore_bytes(data)
    assert onwards(slave, 10, 15) == first
    slave.fmu.freeFMUstate(state)
    # Rates are those of the outputs: differences over two steps have them to second order.
    names = slave.names("output")
    assert 0.0 < first[1][names.index("asperity_load")] < first[1][names.index("load")]
    load, rate = names.index("load"), names.index("der(load)")
    assert first[1][rate] == pytest.approx((first[2][load] - first[0][load]) / (2.0 * STEP), rel=0.05)


def test_a_field_that_is_not_asked_for_changes_no_bit_of_a_formula() -> None:
    with_field, without = Reference("ehl_contact"), Reference("ehl_contact", nodes=0)
    assert with_field.component.structure["nodes"] > 0
    for k in range(20):
        for one in (with_field, without):
            one.set_inputs(wave(one.component, k * STEP))
            one.step(STEP)
        assert with_field.outputs() == without.outputs()
    np.testing.assert_array_equal(with_field.x[:1], without.x)
