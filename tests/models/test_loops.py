"""Algebraic loops: outputs solve their equations whatever the gain, in each form of the evaluation."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from models import kinds
from models.catalogue import CATALOGUE
from models.compile.kernel import kernel
from models.core.component import Component
from models.core.composite import compose
from models.core.evaluation import Evaluation, Interpreted
from models.core.quantities import layouts
from models.core.system import Instance, ModelError, System
from models.monolithic.slopes import Slopes
from models.valve_train.cams.law import law_lift
from models.valve_train.camshaft import camshaft

from .systems import VALVE_TRAIN

EVALUATIONS = pytest.mark.parametrize("kind", [Interpreted, Evaluation])


@dataclass
class BlockParameters:
    gain: float = kinds.NUMBER("slope of the answer to the other's answer", 0.5)
    share: float = kinds.NUMBER("slope of the answer to the other's state", 0.3)


@dataclass
class BlockState:
    value: float = kinds.NUMBER("state", 1.0)


@dataclass
class BlockInputs:
    state: float = kinds.NUMBER("the other's state")
    answer: float = kinds.NUMBER("the other's answer")


@dataclass
class BlockOutputs:
    state: float = kinds.NUMBER("the state, which needs no input")
    answer: float = kinds.NUMBER("state + gain * other's answer + share * other's state")


@kernel
def block_output(t, x, u, p, y):
    y.state = x.value
    y.answer = x.value + p.gain * u.answer + p.share * u.state


@kernel
def block_derivative(t, x, u, p, dx):
    dx.value = u.answer


@kernel
def no_energy(t, x, u, p, e):
    e[:] = 0.0


BLOCK = Component(
    name="block",
    description="linear block",
    **layouts(BlockParameters, BlockState, BlockInputs, BlockOutputs),
    derivative=block_derivative,
    output=block_output,
    energy=no_energy,
    feedthrough={"answer": ("answer", "state")},
)


def find_sources(gains, size):
    """Of each of `size` blocks in a ring the one before."""
    return [i - 1 if i % size else i + size - 1 for i in range(len(gains))]


def build_rings(gains, size=2):
    return System(
        {f"block_{i}": Instance(BLOCK, {"gain": gain}, {"value": 1.0 + i}) for i, gain in enumerate(gains)},
        [
            (f"block_{j}.{port}", f"block_{i}.{port}")
            for i, j in enumerate(find_sources(gains, size))
            for port in ("state", "answer")
        ],
    )


def solve_rings(gains, size=2):
    """The blocks' answers, from their linear system."""
    x, seen = 1.0 + np.arange(len(gains)), np.eye(len(gains))[find_sources(gains, size)]
    return np.linalg.solve(np.eye(len(gains)) - np.array(gains)[:, None] * seen, x + 0.3 * seen @ x)


@EVALUATIONS
@pytest.mark.parametrize(
    ("gains", "size", "torn"),
    [
        ((0.5, 0.02), 2, 1),
        ((0.9, 0.95), 2, 1),
        ((1.0, -1.0), 2, 1),
        ((1.5, 2.0), 2, 1),
        ((-30.0, 4.0), 2, 1),
        ((0.9, -0.8, 3.0), 3, 1),
        ((0.9, 0.95, -30.0, 4.0), 2, 2),
    ],
)
def test_answers_of_linear_blocks_solve_their_linear_system(kind, gains, size, torn):
    """The torn block is computed twice, as the next one sees its state. Two evaluations of all give the slope
    of a linear loop, a third its solution."""
    system = build_rings(gains, size)
    assert (len(system.torn), len(system.order)) == (torn, len(gains) + torn)
    evaluation = kind(system)
    calls, evaluate = [], evaluation._evaluate
    evaluation._evaluate = lambda t, x: calls.append(t) or evaluate(t, x)
    y = evaluation.outputs(0.0, system.x0)
    assert len(calls) <= 2 + torn
    # The loop's tolerance of 1e-12, over one minus its gain.
    np.testing.assert_allclose(y[1::2], solve_rings(gains, size), rtol=1e-11)
    np.testing.assert_allclose(evaluation.derivative(0.0, system.x0), evaluation.u[1::2], rtol=0.0)
    np.testing.assert_array_equal(evaluation.u[system.target_index], evaluation.y[system.source_index])


@EVALUATIONS
def test_a_gain_of_one_has_no_solution(kind):
    system = build_rings((0.5, 2.0))
    with pytest.raises(ModelError, match=r"algebraic loop through block_\d.answer: no solution"):
        kind(system).outputs(0.0, system.x0)


@EVALUATIONS
def test_outputs_come_back_from_what_is_not_finite(kind):
    system = build_rings((0.9, 0.95))
    evaluation = kind(system)
    assert not np.isfinite(evaluation.outputs(0.0, np.full(2, math.inf))[1])
    np.testing.assert_allclose(evaluation.outputs(0.0, system.x0)[1::2], solve_rings((0.9, 0.95)), rtol=1e-11)


@pytest.mark.parametrize("gains", [(0.9, 0.95), (1.5, 2.0), (-30.0, 4.0)])
def test_a_composite_closes_its_loop_at_any_gain(gains):
    system, exact = build_rings(gains), solve_rings(gains)
    lines = [(str(c.source), str(c.target)) for c in system.connections]
    whole = compose("ring", "", system.instances, lines)
    y, dx = np.zeros(whole.outputs.size), np.zeros(2)
    whole.flat_output(0.0, system.x0, whole.inputs.start, whole.parameters.start, y)
    whole.flat_derivative(0.0, system.x0, whole.inputs.start, whole.parameters.start, dx)
    np.testing.assert_allclose(y[1::2], exact, rtol=1e-12)
    np.testing.assert_allclose(dx, exact[::-1], rtol=1e-12)


RATIO, CAM_INERTIA, TORQUE, LOAD, DEGREES = 0.5, 3.0e-4, 3.0, 400.0, 120.0


def light_train(inertia):
    """A free flywheel on a rigid camshaft under a load, and its acceleration by hand.

    (J + I r^2) w' = T - r W s'; the gain of the loop is -I r^2 / J.
    """
    system = System(
        {
            "flywheel": Instance(
                CATALOGUE["flywheel"](),
                {"motion": 0.0, "inertia": inertia},
                start={"angle": math.radians(DEGREES) / RATIO},
                inputs={"drive_torque": TORQUE},
            ),
            "camshaft": Instance(
                CATALOGUE["camshaft"](), {"drive_ratio": RATIO}, inputs={"contact_load": LOAD}
            ),
        },
        [c for c in VALVE_TRAIN if c[0].split(".")[0] in ("flywheel", "camshaft") and "contact" not in c[1]],
    )
    slope = law_lift(math.radians(DEGREES), camshaft().parameters.defaults()).ds
    return system, (TORQUE - RATIO * LOAD * slope) / (inertia + CAM_INERTIA * RATIO**2)


@pytest.mark.parametrize("inertia", [0.02, 8e-5, 2e-5])
def test_a_free_flywheel_accelerates_with_its_rigid_camshaft(inertia):
    """Gains of -0.004, -0.94 and -3.8. By the flywheel's inertia the slope is -w' / (J + I r^2)."""
    system, exact = light_train(inertia)
    assert system.torn
    evaluation = Evaluation(system)
    y = evaluation.outputs(0.0, system.x0)
    # The loop's tolerance of nominal 100 rad/s^2 and value.
    assert y[system.outputs.names.index("flywheel.acceleration")] == pytest.approx(exact, rel=1e-11)
    speed = system.state.names.index("flywheel.speed")
    assert evaluation.derivative(0.0, system.x0)[speed] == pytest.approx(exact, rel=1e-11)
    place = system.parameters.names.index("flywheel.inertia")
    slopes = Slopes(system, [[(place, 1.0)]]).at(np.zeros(1), system.x0[None])[0]
    by_inertia = -exact / (inertia + CAM_INERTIA * RATIO**2)
    assert slopes[speed, -1] == pytest.approx(by_inertia, rel=1e-11)
