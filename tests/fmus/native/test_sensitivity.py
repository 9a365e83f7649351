"""Directional derivatives of native FMUs are those of the component's outputs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from fmus.build import default_structure
from fmus.native.differentiate import DifferentiationError, differentiated

from ..instance import Instance
from ..reference import Reference, held, wave
from .names import EVERY

# Half steps of the differences, in nominal sizes: the best of several, as outputs are bent differently.
STEPS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
# Truncation and rounding that the best of these differences has left in smooth functions of doubles.
RELATIVE, ROUNDING = 1e-5, 1e-10


def moving(name: str, fmu: Path) -> tuple[Reference, Instance]:
    """The component and its FMU after some steps; inputs are held there."""
    reference = Reference(name, **default_structure(name, "NATIVE_STRUCTURE"))
    slave = Instance(fmu).initialize()
    for _ in range(20):
        values = held(wave(reference.component, reference.t))
        reference.set_inputs(values)
        slave.set(values)
        slave.step(reference.t, 1e-5)
        reference.step(1e-5)
    return reference, slave


def differences(reference: Reference, place: int) -> tuple[np.ndarray, np.ndarray]:
    """Central differences of all outputs by an input, a row for each step; and the rounding of each."""
    component = reference.component
    size, rows, rounding = component.inputs.nominal[place], [], []
    for step in STEPS:
        ends = []
        for side in (1.0, -1.0):
            u, y = reference.u.copy(), np.zeros(component.outputs.size)
            u[place] += side * step * size
            component.flat_output(reference.t, reference.x, u, reference.p, y)
            ends.append(y)
        rows.append((ends[0] - ends[1]) / (2.0 * step * size))
        rounding.append(ROUNDING * (np.abs(ends[0]) + np.abs(ends[1])) / size)
    return np.array(rows), np.array(rounding)


@pytest.mark.parametrize("name", EVERY)
def test_derivatives_of_outputs_by_inputs(name: str, native_files: dict[str, Path]) -> None:
    reference, slave = moving(name, native_files[name])
    layout = reference.component.outputs
    names = [name for name in layout.names if slave.variables[name].type == "Real"]
    real = [layout.index(name) for name in names]
    outputs = [slave.variables[name].valueReference for name in names]
    for place, name_of_input in enumerate(reference.component.inputs.names):
        known = [slave.variables[name_of_input].valueReference]
        found = np.array(slave.fmu.getDirectionalDerivative(outputs, known, [1.0]))
        expected, rounding = (values[:, real] for values in differences(reference, place))
        error = np.abs(found - expected) - RELATIVE * np.abs(expected) - rounding
        worst = int(np.argmax(error.min(axis=0)))
        assert error.min(axis=0)[worst] <= 0.0, (name_of_input, names[worst])
    slave.free()


def test_derivatives_are_linear_in_the_direction(native_files: dict[str, Path]) -> None:
    """Along (a, b) they are a times those along (1, 0) and b times those along (0, 1), to rounding."""
    _, slave = moving("ehl_contact", native_files["ehl_contact"])
    outputs = [slave.variables[name].valueReference for name in ("load", "half_width", "deflection")]
    known = [slave.variables[name].valueReference for name in ("approach", "radius_of_curvature")]

    def along(*direction: float) -> np.ndarray:
        return np.array(slave.fmu.getDirectionalDerivative(outputs, known, list(direction)))

    expected = 3.0 * along(1.0, 0.0) - 0.5 * along(0.0, 1.0)
    np.testing.assert_allclose(along(3.0, -0.5), expected, rtol=1e-14)
    slave.free()


@pytest.mark.parametrize(
    ("unknown", "known", "said"),
    [
        ("der(surface_position)", "drive_angle", "derivatives are of outputs"),
        ("surface_position", "surface_velocity", "derivatives are by inputs"),
        ("surface_position", "flexible", "derivatives are by inputs"),
    ],
)
def test_what_has_no_derivative_is_said(
    native_files: dict[str, Path], unknown: str, known: str, said: str
) -> None:
    slave = Instance(native_files["camshaft"]).initialize()
    references = [[slave.variables[name].valueReference] for name in (unknown, known)]
    with pytest.raises(FMICallException):
        slave.fmu.getDirectionalDerivative(*references, [1.0])
    assert said in slave.messages[-1][2]
    slave.free()


def test_code_without_known_derivative_is_refused() -> None:
    code = """
    declare double @j0(double)
    define i32 @kernel_output(ptr %retptr, ptr %excinfo, double %arg.t, ptr %arg.y) {
      %v = call double @j0(double %arg.t)
      store double %v, ptr %arg.y
      ret i32 0
    }
    """
    with pytest.raises(DifferentiationError, match="@j0"):
        differentiated(code, ["output"])
