"""Participants that are exactly linear: x' = A x + B u, y = C x + D u about a point of a component.

A coupled run of such participants, by any master, is a linear map from one macro step to the next; that
is what `operator` reads out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import expm

from models.quantities import Layout, Vector
from models.system import Instance

# Differences reach this share of the nominal size (or of the value, if larger): the rounding of a double,
# 1e-16, over it and its square, the truncation of a central difference, are below 1e-9.
SHARE = 1e-6
# Slopes to both sides that differ by more than this share of the larger one are a kink: the truncation of
# one-sided differences is of the order of SHARE.
KINK = 1e-2
# What a kernel's result may be rounded by, of its size: a thousand roundings of a double.
ROUNDING = 1e-13
# Coefficients of the inputs' polynomials: one more than a signal has (four), for its first error.
ROWS = 5


@dataclass(frozen=True, eq=False)
class Linear:
    """Matrices about a point, and the states and inputs at which the point is a kink.

    At a kink the slope is that of the side where it is larger: the stiffer one.
    """

    A: Vector
    B: Vector
    C: Vector
    D: Vector
    kinks: tuple[str, ...] = ()
    _steps: dict[float, tuple[Vector, Vector, Vector]] = field(default_factory=dict, repr=False)

    def step(self, h: float) -> tuple[Vector, Vector, Vector]:
        """(Phi, Gamma, E) for inputs u(s) = sum over k of U[k] s^k/k!, with the rows of U one after another.

        x(h) = Phi x(0) + Gamma U, and E U are u(h) and u'(h). Exact: from the matrix exponential of the
        state with the inputs' derivatives as further states (Van Loan 1978).
        """
        if h not in self._steps:
            n, inputs = self.B.shape
            # Inputs without effect on the states would only make the exponential larger.
            moving = np.flatnonzero(np.any(self.B, axis=0))
            m = moving.size
            whole = np.zeros((n + ROWS * m, n + ROWS * m))
            whole[:n, :n] = h * self.A
            if m:
                whole[:n, n : n + m] = h * self.B[:, moving]
                # The chain of derivatives has U[k] h^k as states, which keeps it free of powers of h.
                whole[n:-m, n + m :] = np.eye((ROWS - 1) * m)
            made = expm(whole) if np.any(whole) else np.eye(len(whole))
            gamma = np.zeros((n, ROWS, inputs))
            gamma[:, :, moving] = made[:n, n:].reshape(n, ROWS, m) * (h ** np.arange(ROWS))[:, None]
            chain = [[h**k / math.factorial(k) for k in range(ROWS)]]
            chain.append([0.0, *chain[0][:-1]])
            ends = np.kron(np.array(chain), np.eye(inputs))
            self._steps[h] = made[:n, :n].copy(), gamma.reshape(n, ROWS * inputs), ends
        return self._steps[h]


def linearised(instance: Instance, t: float, x: Vector, u: Vector, outputs: Collection[str]) -> Linear:
    """The instance about (t, x, u), with zero rows for outputs other than `outputs`.

    Whole numbers (modes, counts, flags) are parameters of the point.
    """
    c = instance.component
    p = c.parameters.vector(instance.parameters)
    x, u = np.array(x, dtype=np.float64), np.array(u, dtype=np.float64)

    def rates(x: Vector, u: Vector) -> Vector:
        rate, output = np.zeros(c.state.size), np.zeros(c.outputs.size)
        c.flat_derivative(t, x, u, p, rate)
        c.flat_output(t, x, u, p, output)
        return np.concatenate([rate, output])

    wanted = np.array([True] * c.state.size + [name in outputs for name in c.outputs.names])
    smooth = [not item.quantity.discrete for item in (*c.state.fields, *c.outputs.fields)]
    rows = wanted & np.array(smooth)
    by_state, kinks = _slopes(lambda v: np.where(rows, rates(v, u), 0.0), x, c.state)
    by_input, more = _slopes(lambda v: np.where(rows, rates(x, v), 0.0), u, c.inputs)
    n = c.state.size
    return Linear(by_state[:n], by_input[:n], by_state[n:], by_input[n:], (*kinks, *more))


def _slopes(function: Callable[[Vector], Vector], at: Vector, layout: Layout) -> tuple[Vector, list[str]]:
    """Derivatives by central differences, and the variables that have a kink at this point."""
    middle = function(at)
    slopes, kinks = np.zeros((middle.size, at.size)), []
    for j, item in enumerate(layout.fields):
        if item.quantity.discrete:
            continue
        reach = SHARE * max(item.quantity.nominal, abs(at[j]))
        up, down = at.copy(), at.copy()
        up[j] += reach
        down[j] -= reach
        forward = (function(up) - middle) / (up[j] - at[j])
        backward = (middle - function(down)) / (at[j] - down[j])
        # Where one side cannot be had (a film below zero), the other speaks for both.
        forward = np.where(np.isfinite(forward), forward, backward)
        backward = np.where(np.isfinite(backward), backward, forward)
        steeper = np.where(np.abs(forward) >= np.abs(backward), forward, backward)
        rounding = ROUNDING * np.abs(middle) / reach
        kinked = np.abs(forward - backward) > KINK * np.abs(steeper) + rounding
        slopes[:, j] = np.where(kinked, steeper, 0.5 * (forward + backward))
        if np.any(kinked):
            kinks.append(item.name)
    return np.nan_to_num(slopes), kinks


class LinearParticipant:
    """Implements `Participant` for the deviation of an instance from a course that it is linear about.

    The course is the point itself unless `follow` gives it inputs and outputs of its own in the next step.
    What comes in and goes out is course plus deviation; the state `x` is the deviation.
    """

    restorable = True

    def __init__(self, name: str, instance: Instance, linear: Linear) -> None:
        self.name = name
        self._component, self._linear = instance.component, linear
        inputs, outputs = linear.B.shape[1], linear.C.shape[0]
        self.x = np.zeros(linear.A.shape[0])
        self._U = np.zeros((ROWS, inputs))
        self.course = np.zeros((ROWS, inputs))
        self.course_end = np.zeros((2, outputs))
        # Deviation of the inputs at present, and its rate; the course's outputs and rates there.
        self._u = np.zeros((2, inputs))
        self._y = np.zeros((2, outputs))

    def follow(self, inputs: Vector, outputs: Vector) -> None:
        """The course in the next step: Taylor coefficients (ROWS x inputs) of its inputs, and its outputs
        and their rates (2 x outputs) after the step."""
        self.course, self.course_end = inputs, outputs

    def standstill(self) -> tuple[Vector, Vector]:
        """What `follow` takes for a course that stays at the point."""
        return np.zeros_like(self.course), np.zeros_like(self.course_end)

    def rest(self) -> None:
        """Onto the point, all deviations zero."""
        for memory in (self.x, self._U, self._u, self._y):
            memory[:] = 0.0

    def connect(
        self,
        input_names: Sequence[str],
        inputs: Vector,
        output_names: Sequence[str],
        outputs: Vector,
        rates: Vector,
    ) -> Sequence[bool]:
        c = self._component
        self._input_index = np.array([c.inputs.index(name) for name in input_names], dtype=np.int64)
        self._output_index = np.array([c.outputs.index(name) for name in output_names], dtype=np.int64)
        self._inputs, self._outputs, self._rates = inputs, outputs, rates
        return [True] * len(output_names)

    def initialise(self, start_time: float, stop_time: float) -> None:
        pass

    def finish_initialisation(self) -> None:
        pass

    def write(self) -> None:
        self._U[: len(self._inputs), self._input_index] = self._inputs
        self._u[:] = self._U[:2] - self.course[:2]

    def advance(self, time: float, step: float) -> None:
        phi, gamma, ends = self._linear.step(step)
        deviation = (self._U - self.course).ravel()
        self.x[:] = phi @ self.x + gamma @ deviation
        self._u[:] = (ends @ deviation).reshape(2, -1)
        self._y[:] = self.course_end

    def read(self) -> None:
        y = self._y[0] + self._linear.C @ self.x + self._linear.D @ self._u[0]
        np.take(y, self._output_index, out=self._outputs)
        if self._rates.size:
            m = self._linear
            rate = self._y[1] + m.C @ (m.A @ self.x + m.B @ self._u[0]) + m.D @ self._u[1]
            np.take(rate, self._output_index, out=self._rates)

    def read_all(self, values: Vector) -> None:
        values[:] = self._y[0] + self._linear.C @ self.x + self._linear.D @ self._u[0]

    def save(self) -> tuple[Vector, ...]:
        return self.x.copy(), self._u.copy(), self._y.copy()

    def restore(self, saved: tuple[Vector, ...]) -> None:
        self.x[:], self._u[:], self._y[:] = saved

    def release(self, saved: tuple[Vector, ...]) -> None:
        pass

    def close(self) -> None:
        pass
