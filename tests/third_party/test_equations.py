"""FMUs for model exchange: references by their equations, and participants that the run integrates."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import tribocosim
from fmus.native.fmu import build
from fmus.native.machine_code import this_platform
from models.core.difference import difference
from models.core.quantities import Vector
from models.core.system import Instance, System
from models.monolithic.cvode import Cvode
from models.monolithic.march import march
from models.monolithic.runge_kutta import RungeKutta
from orchestrator.errors import RunError
from orchestrator.participants.model_exchange.integrated import DrivenEquations
from orchestrator.participants.model_exchange.problem import PartwiseProblem
from orchestrator.participants.open_fmu import open_fmu
from orchestrator.participants.protocol import BoundVariables, Participant
from orchestrator.participants.third_party import read_component
from orchestrator.scenario.files import list_shipped, read_contents
from tests.models.exact_oscillators import quarter_car

from ..fmus.names import mark_long
from .c_fmus import describe2, real2
from .runs import LINES, public, ran, scenario

STEPS = [
    "wheel.position -> chassis.wheel_position",
    "wheel.velocity -> chassis.wheel_velocity",
    "chassis.position -> wheel.chassis_position",
    "chassis.velocity -> wheel.chassis_velocity",
]


HERE = [this_platform()]


def run(
    components: Mapping[str, Mapping[str, Any]], tolerance: Mapping[str, float], **changes: Any
) -> tribocosim.Result:
    """The result of a run with a reference, of a second unless `changes` say else."""
    one = scenario(components, tolerance=dict(tolerance), **({"reference": {}} | changes))
    return tribocosim.run(tribocosim.load(one.model_dump(exclude_unset=True)))


@pytest.mark.parametrize(
    "chassis", [pytest.param("chassis of FMI 3", marks=pytest.mark.long), "chassis of ours"]
)
def test_equations_of_fmus_are_solved_to_the_exact_motion(chassis, tmp_path, record):
    """The quarter car, of two FMUs and of one beside a component, against the matrix exponential."""
    wheel = {"participant": build("quarter_car_wheel", tmp_path, platforms=HERE, fmi=2)}
    other: dict[str, Any] = {"component": "quarter_car_chassis", "participant": "in-process"}
    if chassis == "chassis of FMI 3":
        file = build("quarter_car_chassis", tmp_path, platforms=HERE, fmi=3)
        other = {"participant": file, "process": "own"}
    tables = {"wheel": wheel, "chassis": other}
    result = run(tables, {"chassis.position": 1e-3}, connections=STEPS, macro_step=1e-3)
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


def test_a_doubled_force_is_that_on_half_of_a_part():
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


def test_a_loop_through_fmus_is_closed():
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
def test_public_fmus_move_as_their_equations_say(name, version, record):
    """Against closed forms, and an integration of the written equation; the reference, not the run."""
    variable, stop, solve, tolerance = EXACT[name]
    file = public(f"reference-fmus-{version}/{name}.fmu")
    result = run({"one": {"participant": file}}, {f"one.{variable}": 1.0}, stop_time=stop)
    found = result.reference[f"one.{variable}"].values
    largest = float(np.max(np.abs(found - solve(result.reference["time"].values))))
    record("FMUs", f"{name} of FMI {version}: {variable}", largest, 0.0, "its equations", tolerance=tolerance)


@pytest.mark.long
def test_the_errors_of_an_fmus_own_solver_are_seen():
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


def test_a_run_whose_repetition_with_halved_steps_fails_stays_complete(monkeypatch):
    """The repetition only looks for the cause of the error."""

    def refuse(*arguments: Any) -> None:
        raise RunError("one: takes no shorter steps")

    monkeypatch.setattr("orchestrator.run.reference._repeat", refuse)
    file = {"participant": public("reference-fmus-3/VanDerPol.fmu")}
    summary = run({"one": file}, {"one.x0": 1e-6}, stop_time=0.5).summary
    assert (summary["complete"], summary["exit_status"]) == (True, 1)
    assert "would show the cause, fails: one: takes no shorter steps" in summary["verdict"]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Native FMUs of both versions."""
    folder = tmp_path_factory.mktemp("natives")
    versions = {"quarter_car_wheel": 2, "quarter_car_chassis": 3, "slider_crank": 3}
    return {name: build(name, folder, platforms=HERE, fmi=fmi) for name, fmi in versions.items()}


def integrated(file: Path, **table: Any) -> dict[str, Any]:
    return {"participant": str(file), "interface": "model_exchange", "process": "shared", **table}


@pytest.mark.parametrize(("signal", "order"), [("hold", 1), ("linear", 2), ("quadratic", 3)])
@pytest.mark.long
def test_integrated_fmus_follow_signals_at_their_orders(signal, order, files, tmp_path, record):
    """The quarter car, Jacobi, 1 and 0.5 ms, against the matrix exponential."""
    tables = {
        "wheel": integrated(files["quarter_car_wheel"]),
        "chassis": integrated(files["quarter_car_chassis"]),
    }
    errors = []
    for step in (1e-3, 5e-4):
        master = {"name": "jacobi", "extrapolation": signal}
        one = scenario(tables, connections=STEPS, macro_step=step, master=master)
        _, found = ran(one, tmp_path / f"{step:g}")
        exact = quarter_car(found["time"])[:, 0]
        errors.append(difference(found["chassis.position"], exact).rms)
    measured = math.log2(errors[0] / errors[1])
    case = f"quarter car of FMUs integrated by the go, Jacobi {signal}: order"
    record("Coupling", case, measured, order, "order of the signal", tolerance=0.2)


@contextmanager
def opened(path: Path, stop: float) -> Iterator[tuple[Participant, BoundVariables]]:
    """A slider-crank whose crank turns at 100 rad/s, ready to step."""
    component = read_component(path, "model_exchange")
    unit = open_fmu("mechanism", path, Instance(component))
    names, outputs = ["crank_angle", "crank_speed"], ["psi", "piston_offset"]
    bound = BoundVariables(names, np.zeros((4, 2)), outputs, np.zeros(2), np.zeros(0))
    try:
        unit.connect(bound)
        unit.initialise(0.0, stop)
        bound.inputs[:2] = [[0.0, 100.0], [100.0, 0.0]]
        unit.write()
        unit.finish_initialisation()
        yield unit, bound
    finally:
        unit.close()


def advance(unit: Participant, bound: BoundVariables, steps: Sequence[int], step: float) -> np.ndarray:
    """The outputs after each of the steps of these numbers."""
    rows = []
    for k in steps:
        bound.inputs[0, 0] = 100.0 * k * step
        unit.write()
        unit.advance(k * step, step)
        unit.read()
        rows.append(bound.outputs.copy())
    return np.array(rows)


@pytest.mark.long
def test_a_repeated_step_has_the_same_bits(files):
    """Through impacts; also from a serialised state, in another instance."""
    step = 5e-4
    with opened(files["slider_crank"], 0.1) as (unit, bound):
        before = advance(unit, bound, range(40), step)
        saved = unit.save()
        first = advance(unit, bound, range(40, 120), step)
        unit.restore(saved)
        again = advance(unit, bound, range(40, 120), step)
        data = unit.to_bytes(saved)
    with opened(files["slider_crank"], 0.1) as (other, bound):
        other.restore(other.from_bytes(data))
        elsewhere = advance(other, bound, range(40, 120), step)
    assert np.array_equal(first, again)
    assert np.array_equal(first, elsewhere)
    assert np.count_nonzero(np.diff(np.sign(np.diff(np.concatenate([before, first])[:, 1])))) > 4


@pytest.mark.long
def test_impacts_inside_integrated_steps_are_located(files, record):
    """The shipped slider-crank, whose mechanism's flights and impacts the component solves by itself."""
    content = read_contents(list_shipped()["slider-crank"]) | {"name": "impacts", "stop_time": "60 ms"}
    ours = tribocosim.run(tribocosim.load(content))
    table = content["components"]["slider_crank"]
    content["components"]["slider_crank"] = integrated(files["slider_crank"], parameters=table["parameters"])
    theirs = tribocosim.run(tribocosim.load(content | {"start": "given", "reference": {"enabled": False}}))
    name = "slider_crank.piston_offset"
    found = difference(theirs.coupled[name].values, ours.reference[name].values).relative_rms
    quantity = "slider-crank integrated by the go: piston_offset"
    record("FMUs", quantity, found, 0.0, "reference", tolerance=1e-4)


@pytest.mark.parametrize("version", mark_long(["2", "3"], ["3"]))
def test_a_public_ball_bounces_exactly(version, tmp_path, record):
    """Its own solver is Euler's method with steps of 10 ms."""
    file = public(f"reference-fmus-{version}/BouncingBall.fmu")
    _, found = ran(scenario({"ball": integrated(file)}, stop_time=1.5), tmp_path / "out")
    largest = float(np.max(np.abs(found["ball.h"] - bouncing_ball(found["time"]))))
    case = f"BouncingBall of FMI {version}, integrated by the go: h"
    record("FMUs", case, largest, 0.0, "its equations", tolerance=1e-8)


Indicator = Callable[[float, float, float], float]


class Switching:
    """Stands for the equations of an FMU that is slow where its indicator z(t, x, u) is above zero, or with
    `falls` where it is not."""

    name, states, indicators = "switching", 1, 1

    def __init__(self, indicator: Indicator, falls: bool) -> None:
        self._indicator, self._falls = indicator, falls
        self._t, self._x, self._u = 0.0, np.zeros(1), np.zeros(1)
        self._above, self._sign, self.next_event = falls, 1.0, math.inf

    def initialise(self, start: float, stop: float) -> None:
        pass

    finish_initialisation = enter_events = close = lambda self: None

    def bind_inputs(self, names: Any) -> None:
        pass

    def outputs(self, t: float, x: Vector, u: Vector) -> Vector:
        self._t, self._x, self._u = t, x.copy(), u.copy()
        return self._x

    def rate(self) -> Vector:
        return np.array([1.0 if self._above == self._falls else 0.5])

    def guards(self) -> Vector:
        return self._sign * self._read()

    def iterate(self) -> bool:
        self._above = bool(self._read() > 0.0)
        return False

    def leave_events(self) -> float:
        self._sign = 1.0 if self._read() > 0.0 else -1.0
        return math.inf

    def get_states(self) -> Vector:
        return self._x

    def get_nominal(self) -> Vector:
        return np.ones(1)

    def _read(self) -> Vector:
        return np.array([self._indicator(self._t, self._x[0], self._u[0] if len(self._u) else 0.0)])


# z, whether it falls, and x at the end. Of these zeros each is met exactly.
MET: dict[str, tuple[Indicator, bool, float]] = {
    "rises": (lambda t, x, u: x - 0.55, False, 0.775),
    "falls": (lambda t, x, u: 0.55 - x, True, 0.775),
    "of time": (lambda t, x, u: t - 0.5, False, 0.75),
    "from the start on": (lambda t, x, u: x, False, 0.5),
    "flat": (lambda t, x, u: (x - 0.55) ** 3, False, 0.775),
}
OF_INPUT = {"of an input": (lambda t, x, u: u - 0.5, False, 0.75)}


@pytest.mark.parametrize(("indicator", "falls", "expected"), (MET | OF_INPUT).values(), ids=MET | OF_INPUT)
def test_an_fmu_that_is_integrated_here_has_the_event(indicator, falls, expected):
    """Under the input u = t; x to what a flat zero can be located to, 1e-16^(1/3)."""
    problem = DrivenEquations(Switching(indicator, falls))  # type: ignore[arg-type]
    problem.connect(["u"])
    problem.inputs[1] = 1.0
    z = np.zeros(1)
    problem.iterate_events(0.0, z)
    found, events = march(problem, RungeKutta(problem, 1e-10, False, 0.1), z, 0.0, np.array([1.0]))
    assert found[0, 0] == pytest.approx(expected, abs=1e-5)
    assert len(events) == 1


@pytest.mark.parametrize("method", [Cvode, RungeKutta])
@pytest.mark.parametrize(("indicator", "falls", "expected"), MET.values(), ids=MET)
def test_the_reference_has_the_event(indicator, falls, expected, method, tmp_path):
    component = read_component(describe2(tmp_path / "one.fmu", real2("x", 0, "output")))
    system = System({"one": Instance(component)}, [])
    problem = PartwiseProblem(system, {"one": Switching(indicator, falls)}, {})  # type: ignore[dict-item]
    z = problem.start(0.0, 1.0)
    found, _ = march(problem, method(problem, 1e-10, False, 0.1), z, 0.0, np.array([1.0]))
    assert found[0, 0] == pytest.approx(expected, abs=1e-5)
