"""The host of model exchange, on FMUs of known motion: events of either sign, in time, and of inputs."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fmus.fmi.model_exchange import EventError
from fmus.reference_results.exchange import Hosted, run
from fmus.reference_results.files import Options, Table

GRAVITY = 10.0
# The solver's 1e-11 a step; impacts multiply errors by a few.
TOLERANCE, CLOSE = 1e-11, 1e-8


class Ball:
    """Falls from 1 m with gravity, and thrust while the truth `on` holds; bounces with restitution 0.5.

    `sign` is that of its event indicator above the ground. At `at` (s) it doubles its velocity, a time event.
    """

    def __init__(self, sign: float, at: float = math.inf, endless: bool = False) -> None:
        self.sign, self.at, self.endless = sign, at, endless
        self.h, self.v, self.t, self.push, self.on = 1.0, 0.0, 0.0, 0.0, 0
        self.phase = "new"

    def setupExperiment(self, **_: float) -> None: ...

    def enterInitializationMode(self, **_: float) -> None:
        self.phase = "initialisation"

    def exitInitializationMode(self) -> None:
        self.phase = "event"

    def enterEventMode(self) -> None:
        assert self.phase == "continuous"
        self.phase = "event"

    def enterContinuousTimeMode(self) -> None:
        assert self.phase == "event"
        self.phase = "continuous"

    def newDiscreteStates(self) -> tuple[bool, bool, bool, bool, bool, float]:
        assert self.phase == "event"
        if self.h <= 1e-9 and self.v < 0.0:
            self.v *= -0.5
        if self.t >= self.at:
            self.v, self.at = 2.0 * self.v, math.inf
        return self.endless, False, False, True, self.at < math.inf, self.at

    def completedIntegratorStep(self) -> tuple[bool, bool]:
        return False, False

    def setTime(self, t: float) -> None:
        self.t = t

    def setContinuousStates(self, x: Any, n: int) -> None:
        assert self.phase == "continuous"
        self.h, self.v = x[0], x[1]

    def getContinuousStates(self, x: Any, n: int) -> None:
        x[0], x[1] = self.h, self.v

    def getNominalsOfContinuousStates(self, x: Any, n: int) -> None:
        x[0] = x[1] = 1.0

    def getDerivatives(self, dx: Any, n: int) -> None:
        dx[0], dx[1] = self.v, -GRAVITY + self.push * self.on

    def getEventIndicators(self, z: Any, n: int) -> None:
        z[0] = self.sign * self.h

    def setReal(self, references: list[int], values: list[float]) -> None:
        (self.push,) = values

    def setBoolean(self, references: list[int], values: list[int]) -> None:
        assert self.phase in ("initialisation", "event")
        (self.on,) = values

    def getReal(self, vr: list[int]) -> list[float]:
        return [(self.h, self.v)[reference] for reference in vr]


def variable(name: str, reference: int, kind: str = "Real", causality: str = "local") -> SimpleNamespace:
    return SimpleNamespace(name=name, valueReference=reference, type=kind, causality=causality, shape=None)


DESCRIBED: Any = SimpleNamespace(
    fmiVersion="2.0",
    numberOfContinuousStates=2,
    numberOfEventIndicators=1,
    modelVariables=[
        variable("h", 0),
        variable("v", 1),
        variable("push", 2, causality="input"),
        variable("on", 3, "Boolean", "input"),
    ],
)


def heights(ball: Ball, stop: float, inputs: Table | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Instants and heights, one for each instant."""
    instants = np.linspace(0.0, stop, 41)
    options = Options(0.0, stop, 0.0, 1e-6)
    found = run(Hosted(ball, DESCRIBED, inputs), DESCRIBED, options, instants, ["h", "v"], TOLERANCE)
    last = np.searchsorted(found["time"], instants + 1e-12, side="right") - 1
    return instants, found["h"][last]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_ball_bounces_at_the_instants_of_its_closed_form(sign: float) -> None:
    """First at sqrt(2 h / g), then after 2 v / g each time."""
    fall = math.sqrt(2.0 / GRAVITY)
    times, found = heights(Ball(sign), 1.1)
    begin, speed = fall, 0.5 * GRAVITY * fall
    exact = np.where(times <= fall, 1.0 - 0.5 * GRAVITY * times**2, 0.0)
    while begin < times[-1]:
        s = times - begin
        inside = (s > 0.0) & (s <= 2.0 * speed / GRAVITY)
        exact[inside] = speed * s[inside] - 0.5 * GRAVITY * s[inside] ** 2
        begin, speed = begin + 2.0 * speed / GRAVITY, 0.5 * speed
    np.testing.assert_allclose(found, exact, atol=CLOSE)


def test_an_event_in_time_is_performed_when_it_is_due() -> None:
    """Velocity doubled at 0.2 s: from there on h = h(0.2) - 2 g 0.2 s - g s^2 / 2."""
    times, found = heights(Ball(1.0, at=0.2), 0.3)
    s = np.clip(times - 0.2, 0.0, None)
    before = 1.0 - 0.5 * GRAVITY * np.minimum(times, 0.2) ** 2
    np.testing.assert_allclose(found, before - 2.0 * GRAVITY * 0.2 * s - 0.5 * GRAVITY * s**2, atol=CLOSE)


def test_inputs_are_lines_between_corners_and_truths_are_events() -> None:
    """No thrust until 0.1 s, then one that grows from 0 with 60 m/s^3 while `on`: h = ... + 60 s^3 / 6."""
    inputs = Table(
        np.array([0.0, 0.1, 0.1, 0.4]),
        {"push": np.array([7.0, 7.0, 0.0, 18.0]), "on": np.array([0.0, 0.0, 1.0, 1.0])},
    )
    times, found = heights(Ball(1.0), 0.4, inputs)
    s = np.clip(times - 0.1, 0.0, None)
    np.testing.assert_allclose(found, 1.0 - 0.5 * GRAVITY * times**2 + 10.0 * s**3, atol=CLOSE)


def test_an_event_without_end_is_given_up() -> None:
    with pytest.raises(EventError, match="takes more than 1000 iterations"):
        heights(Ball(1.0, endless=True), 0.1)
