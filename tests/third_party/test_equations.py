"""References by the equations of third-party FMUs: model exchange, solved together without splitting."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import tribocosim
from fmus.native.fmu import build
from fmus.native.machine_code import this_platform
from models.core.difference import difference
from models.oscillators.exact import quarter_car

from ..fmus.names import mark_long
from .masses import LINES
from .public import public
from .runs import scenario

STEPS = [
    "wheel.position -> chassis.wheel_position",
    "wheel.velocity -> chassis.wheel_velocity",
    "chassis.position -> wheel.chassis_position",
    "chassis.velocity -> wheel.chassis_velocity",
]


@pytest.fixture(scope="module")
def parts(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, Any]]:
    """Tables of the quarter car's parts: native FMUs that stand for themselves, and a component."""
    folder = tmp_path_factory.mktemp("natives")
    here = [this_platform()]
    return {
        "wheel of FMI 2": {"participant": build("quarter_car_wheel", folder, platforms=here, fmi=2)},
        "chassis of FMI 3": {
            "participant": build("quarter_car_chassis", folder, platforms=here, fmi=3),
            "process": "own",
        },
        "chassis of ours": {"component": "quarter_car_chassis", "participant": "in-process"},
    }


def run(
    components: Mapping[str, Mapping[str, Any]], tolerance: Mapping[str, float], **changes: Any
) -> tribocosim.Result:
    """The result of a run with a reference, of a second unless `changes` say else."""
    one = scenario(components, tolerance=dict(tolerance), **({"reference": {}} | changes))
    return tribocosim.run(tribocosim.load(one.model_dump(exclude_unset=True)))


@pytest.mark.parametrize(
    "chassis", [pytest.param("chassis of FMI 3", marks=pytest.mark.long), "chassis of ours"]
)
def test_equations_of_fmus_are_solved_to_the_exact_motion(
    chassis: str, parts: dict[str, dict[str, Any]], record: Any
) -> None:
    """The quarter car, of two FMUs and of one beside a component, against the matrix exponential."""
    result = run(
        {"wheel": parts["wheel of FMI 2"], "chassis": parts[chassis]},
        {"chassis.position": 1e-3},
        connections=STEPS,
        macro_step=1e-3,
    )
    exact = quarter_car(result.reference["time"].values)[:, 0]
    found = result.reference["chassis.position"].values
    case = f"quarter car of a native wheel and a {chassis}: chassis.position"
    largest = float(np.max(np.abs(found - exact)))
    record("FMUs", case, largest, 0.0, "matrix exponential", tolerance=1e-10)
    error = result.summary["errors"]["chassis.position"]["relative_rms"]
    assert error == pytest.approx(
        difference(result.coupled["chassis.position"].values, exact).relative_rms, rel=1e-5
    )
    assert result.summary["reference_method"] == "monolithic"


def test_a_doubled_force_is_that_on_half_of_a_part() -> None:
    """m x'' + d x' + k x = 2 F is (m x'' + d x' + k x)/2 = F: by a factor, and by parameters."""
    whole = {"mass": 1.0, "stiffness": 10.0, "damping": 0.5}
    half = {name: 0.5 * value for name, value in whole.items()}
    plain = tribocosim.load("two-masses").with_({"start": "given", "components.first.start.position": 1.0})
    doubled = plain.with_(
        {
            "components.second.parameters": whole,
            "connections": [line.replace("first.force ->", "first.force * 2 ->") for line in LINES],
        }
    )
    halved = plain.with_({"components.second.parameters": half})
    one, other = (tribocosim.run(s).reference["second.position"].values for s in (doubled, halved))
    np.testing.assert_allclose(one, other, atol=1e-10)
    assert np.ptp(one) > 1e-2


def test_a_loop_through_fmus_is_closed() -> None:
    """u = y/2 + 1 and y = u: both are 2."""
    file = {"participant": public("reference-fmus-2/Feedthrough.fmu")}
    result = run(
        {"one": file, "other": file},
        {"one.Float64_continuous_output": 1e-3},
        connections=[
            "one.Float64_continuous_output * 0.5 + 1 -> other.Float64_continuous_input",
            "other.Float64_continuous_output -> one.Float64_continuous_input",
        ],
    )
    np.testing.assert_allclose(result.reference["one.Float64_continuous_output"], 2.0, rtol=1e-12)


def van_der_pol(times: Any) -> Any:
    """x0'' = (1 - x0^2) x0' - x0 from x0 = 2 at rest."""
    found = solve_ivp(
        lambda t, x: [x[1], (1.0 - x[0] ** 2) * x[1] - x[0]],
        (0.0, times[-1]), [2.0, 0.0], "DOP853", times, rtol=1e-12, atol=1e-12,
    )  # fmt: skip
    return found.y[0]


def bouncing_ball(times: Any) -> Any:
    """Height of a ball that falls from 1 m and keeps 0.7 of its speed in each bounce."""
    gravity, heights = 9.81, []
    for t in times:
        speed, begin, length = 0.0, -math.sqrt(2.0 / gravity), 2.0 * math.sqrt(2.0 / gravity)
        while begin + length < t:
            begin, length = begin + length, 0.7 * length
        speed = 0.5 * gravity * length
        s = t - begin
        heights.append(speed * s - 0.5 * gravity * s**2)
    return np.array(heights)


EXACT = {
    "VanDerPol": ("x0", 10.0, van_der_pol, 1e-9),
    "Dahlquist": ("x", 5.0, lambda times: np.exp(-times), 1e-10),
    "BouncingBall": ("h", 1.5, bouncing_ball, 1e-9),
    "Stair": ("counter", 8.5, lambda times: np.floor(times + 1e-9) + 1.0, 0.0),
}


@pytest.mark.parametrize("version", mark_long(["2", "3"], ["3"]))
@pytest.mark.parametrize("name", mark_long(EXACT, ["BouncingBall"]))
def test_public_fmus_move_as_their_equations_say(name: str, version: str, record: Any) -> None:
    """Against closed forms, and an integration of the written equation; the reference, not the run."""
    variable, stop, solve, tolerance = EXACT[name]
    file = public(f"reference-fmus-{version}/{name}.fmu")
    result = run({"one": {"participant": file}}, {f"one.{variable}": 1.0}, stop_time=stop)
    found = result.reference[f"one.{variable}"].values
    largest = float(np.max(np.abs(found - solve(result.reference["time"].values))))
    record("FMUs", f"{name} of FMI {version}: {variable}", largest, 0.0, "its equations", tolerance=tolerance)


@pytest.mark.long
def test_the_errors_of_an_fmus_own_solver_are_seen() -> None:
    """VanDerPol steps by Euler's method: refinement of macro steps sees nothing of it, its equations do."""
    file = {"participant": public("reference-fmus-3/VanDerPol.fmu")}
    seen, unseen = (
        run({"one": file}, {"one.x0": 1e-6}, stop_time=10.0, reference={"method": method}).summary
        for method in ("monolithic", "refinement")
    )
    assert seen["errors"]["one.x0"]["relative_rms"] > 1e-2
    assert unseen["errors"]["one.x0"]["relative_rms"] < 1e-9
    assert (seen["exit_status"], unseen["exit_status"]) == (1, 0)
    assert "own solvers" in seen["verdict"]
