"""An independent integration of Kushwaha's valve train, from the printed equations and their corrections.

Nothing here comes from `models`: an error of the physics there shows as a difference. K: Kushwaha, Rahnejat
and Jin 2000; the parameters are the set `kushwaha2000`. SI units; the cam's nose is at pi.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

LIFT, BASE = 8e-3, 2.610272395869072 * 8e-3
RISE, DWELL = math.radians(88.66608103115016), math.radians(1.333918968849847)
VALVE_MASS, PRELOAD, RATE, SURGE, SPRING_RATIO = 0.22, 330.0, 35e3, 504.5, 0.02
LENGTH, COMPLIANCE = 12e-3, 2.0 * (1.0 - 0.3**2) / 207e9
VISCOSITY, PRESSURE_VISCOSITY, SQUEEZE = 0.036, 1.8e-8, 96.775
DAMPING, REFERENCE_LOAD = 920.0, 450.0
CAM_MASS, POLAR, TRANSVERSE, SHAFT_RATIO = 0.425, 3.00e-4, 1.42e-4, 0.02
SHAFT_LENGTH, DIAMETER, YOUNG, POISSON = 0.1, 0.02, 207e9, 0.3

# K (1) with the square of f0, K (2), K (3).
COIL_MASS = 2.0 / 3.0 * RATE / (math.pi**2 * SURGE**2)
END, MIDDLE = 8.0 / 3.0 * RATE, 4.0 * RATE
# Stiffness-proportional damping of the ratio at f0.
PROPORTION = 2.0 * SPRING_RATIO / (2.0 * math.pi * SURGE)

STATES = (
    "valve_spring.position", "valve_spring.velocity", "valve_spring.coil_position[1]",
    "valve_spring.coil_velocity[1]", "valve_spring.coil_position[2]", "valve_spring.coil_velocity[2]",
    "contact.film_thickness", "camshaft.twist", "camshaft.twist_rate", "camshaft.bending",
    "camshaft.bending_rate", "camshaft.slope", "camshaft.slope_rate", "camshaft.bending_across",
    "camshaft.bending_across_rate", "camshaft.slope_across", "camshaft.slope_across_rate",
)  # fmt: skip
OUTPUTS = (
    "contact.load", "contact.film_thickness", "valve_spring.position", "valve_spring.coil_position[1]",
    "valve_spring.coil_position[2]", "camshaft.surface_position", "camshaft.drive_torque",
)  # fmt: skip


def cam(psi: float) -> tuple[float, float, float]:
    """s, s' and s'' by K (31): cycloidal rise, dwell about the nose, mirrored fall."""
    before_nose = math.pi - psi % (2.0 * math.pi)
    a = RISE + DWELL - abs(before_nose)
    if a <= 0.0:
        return 0.0, 0.0, 0.0
    if a >= RISE:
        return LIFT, 0.0, 0.0
    turned = 2.0 * math.pi * a / RISE
    first = LIFT / RISE * (1.0 - math.cos(turned))
    second = LIFT / RISE * 2.0 * math.pi / RISE * math.sin(turned)
    return LIFT * (a / RISE - math.sin(turned) / (2.0 * math.pi)), math.copysign(first, before_nose), second


def approach_of(load: float, radius: float) -> float:
    """Elastic deflection under a load: K (6), (7), (9)."""
    b = math.sqrt(4.0 * load * radius * COMPLIANCE / (math.pi * LENGTH))
    p0 = 2.0 * load / (math.pi * b * LENGTH)
    return b * p0 * COMPLIANCE * (math.log(2.0 * LENGTH / b) + 0.5)


def hertz_load(delta: float, radius: float) -> float:
    """The load of a deflection, by Newton's method from within a factor of two."""
    if delta <= 0.0:
        return 0.0
    low, high = 0.0, 1.0
    while approach_of(high, radius) < delta:
        low, high = high, 2.0 * high
    load = 0.5 * (low + high)
    for _ in range(60):
        b = math.sqrt(4.0 * load * radius * COMPLIANCE / (math.pi * LENGTH))
        # d delta/dW = 2 compliance ln(2 L/b) / (pi L), as b grows with the root of W.
        slope = 2.0 * COMPLIANCE * math.log(2.0 * LENGTH / b) / (math.pi * LENGTH)
        step = (delta - approach_of(load, radius)) / slope
        load += step
        if abs(step) < 1e-14 * load:
            break
    return load


def steady_film(load: float, velocity: float, radius: float) -> float:
    """K (10) without squeeze, its load exponent as printed, with E = pi / compliance."""
    modulus = math.pi / COMPLIANCE
    w = load / (modulus * radius * LENGTH)
    u = VISCOSITY * velocity / (modulus * radius)
    g = PRESSURE_VISCOSITY * modulus
    return 1.67 * radius * w**0.059 * u**0.541 * g**0.421


def bending_matrices() -> tuple[list[list[float]], list[list[float]]]:
    """K (33) of the shaft's free end in (deflection, slope), and a C with one damping ratio for all modes."""
    inertia = math.pi * DIAMETER**4 / 64.0
    e, length = YOUNG * inertia, SHAFT_LENGTH
    stiffness = np.array(
        [[12.0 * e / length**3, -6.0 * e / length**2], [-6.0 * e / length**2, 4.0 * e / length]]
    )
    mass = np.diag([CAM_MASS, TRANSVERSE])
    root = np.sqrt(mass)
    squares, modes = np.linalg.eigh(np.linalg.inv(root) @ stiffness @ np.linalg.inv(root))
    damping = root @ modes @ np.diag(2.0 * SHAFT_RATIO * np.sqrt(squares)) @ modes.T @ root
    return stiffness.tolist(), damping.tolist()


TORSION = YOUNG / (2.0 * (1.0 + POISSON)) * math.pi * DIAMETER**4 / 32.0 / SHAFT_LENGTH
TORSION_DAMPING = 2.0 * SHAFT_RATIO * math.sqrt(TORSION * POLAR)
BENDING, BENDING_DAMPING = bending_matrices()


@dataclass(frozen=True)
class Train:
    """A valve train with a film at a constant cam speed (rad/s), on a rigid or a flexible shaft."""

    speed: float
    flexible: bool = False

    def angle(self, t: float, x: list[float]) -> float:
        return self.speed * t + x[7] - 0.5 * x[11] * x[15]

    def contact(self, t: float, x: list[float]) -> tuple[float, float, float]:
        """Load, rate of the film and contact offset s'."""
        s, ds, dds = cam(self.angle(t, x))
        omega = self.speed + x[8] - 0.5 * (x[12] * x[15] + x[11] * x[16])
        radius = BASE + s + dds
        delta = s + x[9] - x[0] + x[6]
        elastic = hertz_load(delta, radius)
        u = abs(0.5 * omega * (BASE + s + 2.0 * dds) + 0.5 * x[14])
        film_rate = (
            -u / SQUEEZE * math.log(x[6] / steady_film(max(elastic, 1.0), u, radius)) if u > 0.0 else 0.0
        )
        delta_rate = ds * omega + x[10] - x[1] + film_rate
        return elastic * max(0.0, 1.0 + DAMPING / REFERENCE_LOAD * delta_rate), film_rate, ds

    def rates(self, t: float, x: list[float]) -> list[float]:
        """Newton's and Lagrange's laws: K (40)-(42) and (33) with their signs set right, film by K (10)."""
        load, film_rate, ds = self.contact(t, x)
        first = END * (x[0] - x[2]) + PROPORTION * END * (x[1] - x[3])
        second = MIDDLE * (x[2] - x[4]) + PROPORTION * MIDDLE * (x[3] - x[5])
        third = END * x[4] + PROPORTION * END * x[5]
        rates = [
            x[1], (load - PRELOAD - first) / VALVE_MASS,
            x[3], (first - second) / COIL_MASS,
            x[5], (second - third) / COIL_MASS,
            film_rate,
        ]  # fmt: skip
        if not self.flexible:
            return [*rates, *[0.0] * 10]
        own = TORSION * x[7] + TORSION_DAMPING * x[8]
        bend, tilt = self.bend(x, load, own, load * ds)
        twist = -(own + load * ds) / POLAR + 0.5 * (x[15] * tilt.imag - x[11] * tilt.real)
        return [*rates, x[8], twist, x[10], bend.imag, x[12], tilt.imag, x[14], bend.real, x[16], tilt.real]

    def bend(self, x: list[float], load: float, own: float, torque: float) -> tuple[complex, complex]:
        """Accelerations of axis and slope, across + i along: a turning disc on a shaft that turns.

        Lagrange, with the spin w + twist' - Im(slope^* slope')/2 and the cam's angle w t + twist -
        Im(slope^2)/4.
        """
        q, tilt = complex(x[13], x[9]), complex(x[15], x[11])
        q_rate, tilt_rate = complex(x[14], x[10]), complex(x[16], x[12])
        spin = self.speed + x[8] - 0.5 * (tilt.conjugate() * tilt_rate).imag
        damped = self.damp(q, q_rate, tilt, tilt_rate)
        force, moment = (k[0] * q + k[1] * tilt + d for k, d in zip(BENDING, damped, strict=True))
        gyroscopic = POLAR * spin * 1j * tilt_rate - 0.5j * (own + torque) * tilt
        lever = 0.5j * torque * tilt.conjugate()
        return (-1j * load - force) / CAM_MASS, (gyroscopic + lever - moment) / TRANSVERSE

    def damp(self, q: complex, q_rate: complex, tilt: complex, tilt_rate: complex) -> list[complex]:
        """Force and moment of the damping, which turns with the shaft."""
        seen = q_rate - 1j * self.speed * q, tilt_rate - 1j * self.speed * tilt
        return [c[0] * seen[0] + c[1] * seen[1] for c in BENDING_DAMPING]

    def turn_back(self, x: list[float]) -> float:
        """Torque of the flexible shaft on its drive: of twist, and of damping that turns round it."""
        q, tilt = complex(x[13], x[9]), complex(x[15], x[11])
        force, moment = self.damp(q, complex(x[14], x[10]), tilt, complex(x[16], x[12]))
        bent = (q.conjugate() * force + tilt.conjugate() * moment).imag
        return -TORSION * x[7] - TORSION_DAMPING * x[8] - bent

    def observe(self, t: float, x: list[float]) -> list[float]:
        """Values of `OUTPUTS`."""
        load, _, ds = self.contact(t, x)
        torque = self.turn_back(x) if self.flexible else load * ds
        return [load, x[6], x[0], x[2], x[4], cam(self.angle(t, x))[0] + x[9], torque]

    def start(self) -> list[float]:
        """Near rest on the base circle: the preload carried, the coils undeformed."""
        turning = np.array(BENDING) - 1j * self.speed * np.array(BENDING_DAMPING)
        bend, slope = np.linalg.solve(turning, [-1j * PRELOAD, 0.0]) if self.flexible else (0j, 0j)
        film = steady_film(PRELOAD, 0.5 * self.speed * BASE, BASE)
        position = bend.imag + film - approach_of(PRELOAD, BASE)
        numbers = [bend.imag, 0.0, slope.imag, 0.0, bend.real, 0.0, slope.real, 0.0]
        return [position, 0.0, 0.0, 0.0, 0.0, 0.0, film, 0.0, 0.0, *map(float, numbers)]


def runge_kutta(
    rates: Callable[[float, list[float]], list[float]], x: list[float], t: float, step: float, steps: int
) -> list[list[float]]:
    """The states after each step of the classical method of fourth order, the first one before them."""

    def moved(by: float, slope: list[float]) -> list[float]:
        return [a + by * b for a, b in zip(x, slope, strict=True)]

    states = [x]
    for n in range(steps):
        now = t + n * step
        k1 = rates(now, x)
        k2 = rates(now + 0.5 * step, moved(0.5 * step, k1))
        k3 = rates(now + 0.5 * step, moved(0.5 * step, k2))
        k4 = rates(now + step, moved(step, k3))
        x = moved(step / 6.0, [a + 2.0 * (b + c) + d for a, b, c, d in zip(k1, k2, k3, k4, strict=True)])
        states.append(x)
    return states
