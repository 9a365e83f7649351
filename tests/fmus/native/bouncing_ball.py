"""A ball that bounces until it rests, if given on a spring and shaken: a component with events.

Falling freely, its bounces are a geometric series. On the spring, shaken without gravity, it is the harmonic
impact oscillator.
"""

import math
from dataclasses import dataclass, replace

from models.compile.kernel import kernel
from models.core.component import Component, Events
from models.core.quantities import Quantity, Vector, layouts

GRAVITY, HEIGHT = 10.0, 1.0  # m/s^2, m


@dataclass
class Parameters:
    restitution: float = Quantity("1", "velocity after over before", minimum=0.0).default(0.5)
    threshold: float = Quantity("m/s", "rebound below which it rests", minimum=0.0).default(1e-6)
    gravity: float = Quantity("m/s2", "acceleration downwards").default(GRAVITY)
    spring: float = Quantity("1/s2", "rate over mass of a spring from the ground").default()
    amplitude: float = Quantity("m/s2", "of a periodic acceleration downwards").default()
    frequency: float = Quantity("rad/s", "its frequency").default(1.0)


@dataclass
class State:
    height: float = Quantity("m", "height").default(HEIGHT)
    velocity: float = Quantity("m/s", "velocity").default()
    bounces: float = Quantity("1", "bounces", count=True, internal=True).default()
    last_bounce: float = Quantity("s", "time of the last bounce", internal=True).default()
    approach: float = Quantity("m/s", "velocity before it", internal=True).default()
    resting: float = Quantity("1", "at rest", boolean=True, internal=True).default()


@dataclass
class Inputs:
    push: float = Quantity("m/s2", "acceleration upwards").default()


@dataclass
class Outputs:
    height: float = Quantity("m", "height").default()
    velocity: float = Quantity("m/s", "velocity").default()
    bounces: float = Quantity("1", "bounces", count=True).default()
    last_bounce: float = Quantity("s", "time of the last bounce").default()
    resting: float = Quantity("1", "at rest", boolean=True).default()


@kernel
def shake(t: float, p: Parameters) -> float:
    return p.amplitude * math.cos(p.frequency * t)


@kernel
def derivative(t: float, x: State, u: Inputs, p: Parameters, dx: State) -> None:
    moving = 1.0 - x.resting
    dx.height = moving * x.velocity
    dx.velocity = moving * (u.push - p.gravity - p.spring * x.height - shake(t, p))
    dx.bounces = 0.0
    dx.last_bounce = 0.0
    dx.approach = 0.0
    dx.resting = 0.0


@kernel
def output(t: float, x: State, u: Inputs, p: Parameters, y: Outputs) -> None:
    y.height = x.height
    y.velocity = x.velocity
    y.bounces = x.bounces
    y.last_bounce = x.last_bounce
    y.resting = x.resting


@kernel
def energy(t: float, x: State, u: Inputs, p: Parameters, e: Vector) -> None:
    e[0] = p.gravity * x.height + 0.5 * (x.velocity**2 + p.spring * x.height**2)
    e[1] = 0.0
    e[2] = (u.push - shake(t, p)) * x.velocity


@kernel
def guards(t: float, x: State, u: Inputs, p: Parameters, g: Vector) -> None:
    g[0] = x.height if x.resting == 0.0 else 1.0


@kernel
def transition(k: int, t: float, x: State, u: Inputs, p: Parameters) -> None:
    x.height = 0.0
    x.approach = x.velocity
    x.velocity = abs(x.velocity) * p.restitution
    x.bounces += 1.0
    x.last_bounce = t
    if x.velocity < p.threshold:
        x.velocity = 0.0
        x.resting = 1.0


def bouncing_ball() -> Component:
    return Component(
        name="bouncing_ball",
        description="A ball that bounces",
        **layouts(Parameters, State, Inputs, Outputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={},
        events=Events(1, guards, transition),
        event_counter="bounces",
        event_time="last_bounce",
    )


@dataclass
class WordyParameters(Parameters):
    restitution: float = Quantity("1", "\N{GREEK SMALL LETTER EPSILON}" * 600, minimum=0.0).default(0.5)


def wordy_ball() -> Component:
    """One that says more than goes into a message, in characters of two bytes."""
    parameters = layouts(WordyParameters, State, Inputs, Outputs)["parameters"]
    return replace(bouncing_ball(), name="wordy_ball", parameters=parameters)


def list_bounces(count: int, restitution: float = 0.5) -> list[float]:
    """Instants (s) of the first bounces: sqrt(2 h/g), then flights of 2 v/g, each `restitution` times the one
    before."""
    first = math.sqrt(2.0 * HEIGHT / GRAVITY)
    flights = [2.0 * restitution**k * first for k in range(1, count)]
    return [first + sum(flights[:k]) for k in range(count)]
