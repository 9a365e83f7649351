"""The FMU of the contact with a pressure field: its outputs, their rates and its saved states."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from .instance import Instance
from .reference import Reference

STEP = 1e-5
# Rough enough for asperities to carry a part.
ROUGH = {"roughness": 0.5e-6}
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
    made = Instance(fmu_files["ehl_line_contact"])
    made.initialize(**ROUGH, **at(0.0))
    yield made
    made.free()


def onwards(slave: Instance, first: int, last: int) -> list[list[float]]:
    found = []
    for k in range(first, last):
        slave.set(at(k * STEP))
        slave.step(k * STEP, STEP)
        found.append(slave.outputs())
    return found


@pytest.mark.long
def test_a_solved_film_in_the_fmu_its_rates_and_its_saved_states_to_the_last_bit(slave: Instance) -> None:
    own = Reference("ehl_line_contact")
    for name, value in ROUGH.items():
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
