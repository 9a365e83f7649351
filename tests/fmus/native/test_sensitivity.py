"""Directional derivatives of native FMUs are those of what the component calculates."""

from __future__ import annotations

import math
from collections.abc import Iterator
from ctypes import c_double
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fmus.variable_layout import ENERGIES
from models.core.component import Component

from ..instance import Instance
from ..kinds import EVERY_NATIVE
from ..reference import Reference, joined, wave

# Half steps of the differences, in nominal sizes: the best of several, as outputs are bent differently.
STEPS = (1e-1, 1e-2, 1e-3, 1e-4)
# Of differences with an error of sixth order: places in half steps, weights.
STENCIL = ((1.0, 45.0 / 60.0), (2.0, -9.0 / 60.0), (3.0, 1.0 / 60.0))
GROOVED = "journal_bearing, grooved"
# Parameters that are not as they start, where those are at the edge of their range, leave something out, or
# make films so thin that rates bend within their own differences. A soft support lets the journal lag: where
# the force on a grooved film nearly vanishes it turns about within the differences' steps, which are off by
# 1e-5 then, the derivatives by 2e-9.
GIVEN: dict[str, dict[str, float]] = {
    "valve_spring": {"seat_stiffness": 1e7, "seat_damping": 100.0},
    "ehl_contact": {"inlet_heating": 1.0, "film_heating": 1.0},
    "journal_bearing": {"radial_clearance": 40e-6},
    GROOVED: {"radial_clearance": 40e-6, "film_model": 2, "support_stiffness": 2e6},
    "tappet_spin": {"axial_offset": 2e-3},
}
# What the best of these differences leaves of terms of higher order.
RELATIVE = 1e-7
# Rounding of what is calculated, relative: cancellation may cost five digits of sixteen, and of rates five
# more (models/core/rates.py).
ROUNDING, ROUNDING_OF_RATES = 1e-11, 1e-10


@dataclass(frozen=True)
class Point:
    """Where a component is, and what it calculates there."""

    component: Component
    t: float
    x: np.ndarray
    u: np.ndarray
    du: np.ndarray
    p: np.ndarray

    def moved(self, kind: str, place: int, by: float) -> Point:
        """The same with one of its values changed."""
        values = getattr(self, kind).copy()
        values[place] += by
        return replace(self, **{kind: values})

    def calculated(self) -> np.ndarray:
        """Outputs, energies, rates, derivatives of states."""
        c, t, p = self.component, self.t, self.p
        y, e, yd, dx = (np.zeros(n) for n in (c.outputs.size, 3, c.outputs.size, c.state.size))
        c.flat_output(t, self.x, self.u, p, y)
        c.flat_energy(t, self.x, self.u, p, e)
        c.flat_rates(t, self.x, self.u, self.du, p, np.zeros(c.rates_work_size), yd)
        c.flat_derivative(t, self.x, self.u, p, dx)
        return np.concatenate([y, e, yd, dx])

    def names(self) -> list[str]:
        """Of what is calculated, as variables."""
        outputs, states = self.component.outputs.names, self.component.state.names
        return [
            *outputs,
            *(name for name, _, _ in ENERGIES),
            *(f"der({name})" for name in outputs),
            *(f"der(state.{name})" for name in states),
        ]

    def noise(self) -> np.ndarray:
        """The rounding of each, but for its own size."""
        c, found = self.component, self.calculated()
        states, inputs = found[found.size - c.state.size :] / c.state.nominal, self.du / c.inputs.nominal
        pace = max(1.0, np.abs(states).max(initial=0.0), np.abs(inputs).max())
        size = np.abs(found) * ROUNDING
        outputs = slice(0, c.outputs.size)
        size[c.outputs.size + 3 :][outputs] += ROUNDING_OF_RATES * pace * np.abs(found[outputs])
        return size


def differences(point: Point, kind: str, place: int, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Of all that is calculated, a row for each step; and the rounding of each."""
    rows, rounding = [], []
    for step in STEPS:
        h, row = step * size, np.zeros(len(point.names()))
        for far, weight in STENCIL:
            ends = [point.moved(kind, place, side * far * h).calculated() for side in (1.0, -1.0)]
            row += weight * (ends[0] - ends[1]) / h
        rows.append(row)
        rounding.append(point.noise() / h)
    return np.array(rows), np.array(rounding)


@dataclass(frozen=True)
class Derivatives:
    """What the FMU says of the variables `names` when one value changes, whose size is about `size`."""

    point: Point
    names: list[str]
    kind: str
    place: int
    size: float
    found: np.ndarray

    def missed(self) -> tuple[np.ndarray, np.ndarray]:
        """Distances from differences beyond their rounding, and the differences: a row for each step."""
        every = self.point.names()
        columns = [every.index(name) for name in self.names]
        expected, rounding = (
            values[:, columns] for values in differences(self.point, self.kind, self.place, self.size)
        )
        return np.abs(self.found - expected) - rounding, expected

    def check(self) -> None:
        beyond, expected = self.missed()
        error = beyond - RELATIVE * np.abs(expected)
        worst = int(np.nanargmax(np.nanmin(error, axis=0)))
        best = int(np.nanargmin(error[:, worst]))
        assert error[best, worst] <= 0.0, (
            f"d {self.names[worst]} / d {self.kind}[{self.place}] = {self.found[worst]:.12g} "
            f"and not {expected[best, worst]:.12g}"
        )


def known_by(variables: Any, names: list[str]) -> list[str]:
    """Those of the names that are continuous variables."""
    return [name for name in names if name in variables and variables[name].type == "Real"]


def part_of(name: str) -> str:
    """The component of a case."""
    return name.partition(", ")[0]


def started(name: str) -> Reference:
    reference = Reference(part_of(name))
    for parameter, value in GIVEN.get(name, {}).items():
        reference.p[reference.component.parameters.index(parameter)] = value
    return reference


def moving(name: str, fmu: Path) -> tuple[Reference, Instance]:
    """The component and its FMU after some steps; inputs vary there."""
    reference = started(name)
    slave = Instance(fmu).initialize(**GIVEN.get(name, {}))
    for _ in range(20):
        values = wave(reference.component, reference.t)
        reference.set_inputs(values)
        slave.set(values)
        slave.step(reference.t, 1e-5)
        reference.step(1e-5)
    return reference, slave


def point_of(reference: Reference) -> Point:
    r = reference
    return Point(r.component, r.t, r.x.copy(), r.u.copy(), r.du.copy(), r.p.copy())


def in_motion(name: str, fmu: Path) -> Iterator[Derivatives]:
    """Of outputs, energies and rates by inputs, their derivatives and parameters, in co-simulation."""
    reference, slave = moving(name, fmu)
    point, c = point_of(reference), reference.component
    names = [n for n in known_by(slave.variables, point.names()) if not n.startswith("der(state.")]
    unknown = [slave.variables[n].valueReference for n in names]
    columns = [("u", c.inputs, 0), ("du", c.inputs, 1), ("p", c.parameters, 0)]
    for kind, layout, order in columns:
        for place, field in enumerate(layout.fields):
            variable = slave.variables[joined(field.name, order)]
            if variable.type != "Real" or field.quantity.discrete:
                continue
            size = field.quantity.nominal / (1e-3 if kind == "du" else 1.0)
            if kind == "p":
                if point.p[place] in field.quantity.limits():  # a kink
                    continue
                size = 0.1 * abs(point.p[place]) or size
            found = slave.fmu.getDirectionalDerivative(unknown, [variable.valueReference], [1.0])
            yield Derivatives(point, names, kind, place, size, np.array(found))
    slave.free()


@pytest.mark.parametrize("name", [*EVERY_NATIVE, GROOVED])
def test_derivatives_by_inputs_and_parameters(name, native_files):
    for derivatives in in_motion(name, native_files[part_of(name)]):
        derivatives.check()


def check_states(slave: Instance, point: Point, host: Any) -> None:
    """Outputs, energies, rates and the states' derivatives by each state, as `host` has them."""
    state = point.component.state
    names = known_by(slave.variables, point.names())
    unknown = [slave.variables[n].valueReference for n in names]
    for variable in (u.variable.derivative for u in slave.description.derivatives):
        place = state.index(variable.name.removeprefix("state."))
        found = host.getDirectionalDerivative(unknown, [variable.valueReference], [1.0])
        size = float(state.nominal[place])
        Derivatives(point, names, "x", place, size, np.array(found)).check()


@pytest.mark.parametrize("name", EVERY_NATIVE)
def test_derivatives_by_states(name, native_files):
    """In model exchange, off the start."""
    slave, reference = Instance(native_files[name]), started(name)
    c = reference.component
    states = [u.variable.derivative.name for u in slave.description.derivatives]
    places = [c.state.index(state.removeprefix("state.")) for state in states]
    for i, place in enumerate(places):
        reference.x[place] += 0.1 * c.state.nominal[place] * math.sin(i + 1.0)
    reference.set_inputs(wave(c, 0.0))
    with slave.exchanging(**GIVEN.get(name, {})) as model:
        model.fmi2SetContinuousStates(
            model.component, (c_double * len(places))(*reference.x[places]), len(places)
        )
        for given, value in wave(c, 0.0).items():
            model.setReal([slave.variables[given].valueReference], [value])
        check_states(slave, point_of(reference), model)
    slave.free()


@pytest.mark.parametrize("name", [*EVERY_NATIVE, GROOVED])
def test_derivatives_by_states_between_steps(name, native_files):
    """In co-simulation, at a communication point."""
    reference, slave = moving(name, native_files[part_of(name)])
    check_states(slave, point_of(reference), slave.fmu)
    slave.free()


def test_derivatives_by_start_values(native_files):
    """In initialisation: a state follows its start value, and what is calculated follows the state."""
    slave = Instance(native_files["coupled_mass"])
    slave.fmu.setupExperiment()
    slave.fmu.enterInitializationMode()
    names = ["state.position", "state.velocity", "position", "der(position)", "velocity"]
    unknown, known = (
        [slave.variables[name].valueReference for name in some]
        for some in (names, ["position_start", "velocity_start"])
    )
    assert slave.fmu.getDirectionalDerivative(unknown, known, [3.0, 5.0]) == [3.0, 5.0, 3.0, 5.0, 5.0]
    slave.free()


def test_energies_and_rates_have_the_derivatives_of_their_formulas(native_files, record):
    """Mass on two springs: E = (m v^2 + k x^2 + k_c (x - x_2)^2)/2; F' = k_c (v - x_2') + c_c (a - v_2')."""
    k, k_c, c, c_c, x, v, x_2, v_2, slope = 10.0, 40.0, 0.5, 1.0, 0.3, 2.0, 0.1, 0.7, 5.0
    slave = Instance(native_files["coupled_mass"]).initialize(
        position_start=x, velocity_start=v, other_position=x_2, other_velocity=v_2, other_position_der1=slope
    )

    def derivative(unknown, known):
        references = ([slave.variables[name].valueReference] for name in (unknown, known))
        return float(slave.fmu.getDirectionalDerivative(*references, [1.0])[0])

    force = k * x + c * v + k_c * (x - x_2) + c_c * (v - v_2)
    for unknown, known, exact in (
        ("stored_energy", "other_position", -k_c * (x - x_2)),
        ("dissipated_power", "other_velocity", -2.0 * c_c * (v - v_2)),
    ):
        quantity, found = f"directional derivative of {unknown} by {known}", derivative(unknown, known)
        record("FMUs", quantity, found, exact, "closed form", relative=1e-15)
    assert derivative("source_power", "other_velocity") == 0.0
    for known, expected in {
        "other_position_der1": -k_c,
        "other_velocity_der1": -c_c,
        "other_position_der2": 0.0,
        "other_position": c_c * k_c,
        "other_velocity": c_c * c_c,
        "coupling_stiffness": v - slope - c_c * (x - x_2),
        "mass": c_c * force,
    }.items():
        # As exact as rates (models/core/rates.py): 1e-12 of the largest term in a unit of time.
        assert derivative("der(force)", known) == pytest.approx(expected, rel=1e-10, abs=1e-9), known
    slave.free()


def test_derivatives_are_linear_in_the_direction(native_files):
    """Along (a, b) they are a times those along (1, 0) and b times those along (0, 1), to rounding."""
    _, slave = moving("valve_spring", native_files["valve_spring"])
    outputs = [slave.variables[name].valueReference for name in ("acceleration", "der(acceleration)")]
    known = [slave.variables[name].valueReference for name in ("load", "valve_mass")]

    def along(*direction):
        return np.array(slave.fmu.getDirectionalDerivative(outputs, known, list(direction)))

    expected = 3.0 * along(1.0, 0.0) - 0.5 * along(0.0, 1.0)
    np.testing.assert_allclose(along(3.0, -0.5), expected, rtol=1e-14)
    slave.free()
