"""The constrained (adherence) form of a valve train: the follower rides on the cam, the load is a multiplier.

Kushwaha et al. 2000 (K), sections 2.2, 4.1 and 4.5: y3 = s(psi) + y_c at all times, and the contact load W
is the constraint's force lambda (K (36) multiplies it by ds/dpsi, which belongs to the camshaft's torque).
W is the load for which the accelerations of cam surface and follower are equal,

    s'' psi'^2 + s' psi'' + y_c'' (W) = y3'' (W),

evaluated with the components' own kernels, which are affine in W. W may become negative: K's constraint
pulls where a real contact would open.
"""

import math
import time
from dataclasses import replace

import numpy as np

from models.core.evaluation import Evaluation
from models.core.quantities import Vector
from models.core.system import ModelError, Port, System
from models.monolithic.energy import QUADRATURES, Energies
from models.monolithic.equilibrium import equilibrium
from models.monolithic.problem import Event, check_ode
from models.monolithic.reference import Reference, check_times, solve_twice, uncertainties
from models.valve_train.valve_spring import lumping

# Two loads (N) between which the relative acceleration is known to be affine.
TRIAL_LOAD = 100.0
# Secant steps: one is exact without friction, a few with (its limit depends on the load).
SECANT_STEPS = 30
LOAD_TOLERANCE = 1e-12


def solve_adherence(
    system: System, times: Vector, tolerance: float = 1e-10, massless_spring: bool = False
) -> Reference:
    """Solve a valve train, given in its compliant form, with the follower held to the cam, from t = 0 on.

    `system` has one camshaft, valve_spring and ehl_contact; outputs have the same names as in the compliant
    solution ("contact.load" is the multiplier W, the film follows from it). The follower's own states are
    those of the cam's surface. The start is the compliant system's equilibrium. `massless_spring` leaves out
    the coils' inertia: W = m3 s'' + f_p + k0 s. Two methods, events and `energy` as in `solve`; neither the
    contact nor a massless spring has energy here.
    """
    begun = time.perf_counter()
    times = check_times(times, 0.0)
    problem = AdherenceProblem(system, massless_spring)
    start = problem.start(equilibrium(system, 0.0))
    runs, events, names = solve_twice(problem, start, 0.0, times, tolerance)
    n = problem.size
    states, inputs, outputs = problem.observe(times, runs[0])
    others = problem.observe(times, runs[1])[2]
    stored = problem.energies.along(times, states, inputs)
    return Reference(
        system=problem.system,
        times=times,
        state=states,
        inputs=inputs,
        outputs=outputs,
        uncertainty=uncertainties(problem.system, times, outputs, others),
        events=events,
        energy=problem.energies.balances(stored, runs[0][:, n:], states),
        wall_time_s=time.perf_counter() - begun,
        method_names=names,
    )


class AdherenceProblem:
    """The system's state, in which the follower's place is dependent, followed by energies."""

    guard_count = 0
    next_event = math.inf

    def __init__(self, system: System, massless_spring: bool = False) -> None:
        camshaft = _find_only(system, "camshaft")
        valve = _find_only(system, "valve_spring")
        contact = _find_only(system, "ehl_contact")
        self.system = s = _give_load(system, contact)
        check_ode(s)
        self.massless = massless_spring
        self.evaluation = Evaluation(s)
        without = {contact, valve} if massless_spring else {contact}
        self.energies = Energies(s, tuple(name for name in s.instances if name not in without))
        self.size = s.state.size
        quadratures = QUADRATURES * len(self.energies.instances)
        self.nominal = np.concatenate([s.state.nominal, np.ones(quadratures)])
        self.whole = np.zeros(self.nominal.size, dtype=np.bool_)
        self._x = np.zeros(self.size)
        self._rate = np.zeros(self.nominal.size)
        self._load = s.inputs.index(Port(contact, "applied_load"))
        self._position = s.state.index(Port(valve, "position"))
        self._velocity = s.state.index(Port(valve, "velocity"))
        self._twist_rate = s.state.index(Port(camshaft, "twist_rate"))
        self._bending_rate = s.state.index(Port(camshaft, "bending_rate"))
        self._across = s.state.index(Port(camshaft, "bending_across"))
        self._slopes = tuple(s.state.index(Port(camshaft, name)) for name in ("slope", "slope_across"))
        self._surface, self._surface_rate, self._radius, self._lift, self._offset, self._speed = (
            s.outputs.index(Port(camshaft, name))
            for name in (
                "surface_position",
                "surface_velocity",
                "radius_of_curvature",
                "cam_lift",
                "contact_offset",
                "cam_speed",
            )
        )
        self._drive = s.inputs.index(Port(camshaft, "drive_acceleration"))
        self._ratio = s.p[s.parameters.index(Port(camshaft, "drive_ratio"))]
        self._base = s.p[s.parameters.index(Port(camshaft, "base_radius"))]
        coils = s.instances[valve].component.structure["coil_masses"]
        first = s.state.index(Port(valve, "coil_position[1]"))
        self._coils = slice(first, first + coils)
        self._coil_rates = slice(first + coils, first + 2 * coils)
        share = lumping(coils)
        # Static shape of the coils: every segment carries k0 y3.
        self._shape = 1.0 - 1.0 / share.end_rate - np.arange(coils) / share.inner_rate

    def start(self, x0: Vector) -> Vector:
        """The problem's z for the system's state x0."""
        if x0.shape != (self.size,):
            raise ModelError(f"start state of {x0.size} elements: the system has {self.size} states")
        return np.concatenate([x0, np.zeros(self.nominal.size - self.size)])

    def guards(self, t: float, z: Vector) -> Vector:
        return np.zeros(0)

    def transition(self, guard: int, t: float, z: Vector) -> Event:
        raise AssertionError("no guards")

    def full_state(self, t: float, z: Vector) -> Vector:
        """The system's state with the follower on the cam and the load solved for."""
        x = self._x
        x[:] = z[: self.size]
        y = self.evaluation.outputs(t, x)
        x[self._position] = y[self._surface]
        x[self._velocity] = y[self._surface_rate]
        if self.massless:
            x[self._coils] = x[self._position] * self._shape
            # No rate in the segment at the follower: a spring without inertia has no damping here either.
            x[self._coil_rates] = x[self._velocity]
        self._solve_load(t, x)
        return x.copy()

    def observe(self, times: Vector, rows: Vector) -> tuple[Vector, Vector, Vector]:
        """States, inputs and outputs at `times`, each with the load that is solved for there."""
        found = []
        for t, z in zip(times, rows, strict=True):
            x = self.full_state(float(t), z)
            outputs = self.evaluation.outputs(float(t), x).copy()
            found.append((x, self.evaluation.u.copy(), outputs))
        states, inputs, outputs = (np.array(column) for column in zip(*found, strict=True))
        return states, inputs, outputs

    def rate(self, t: float, z: Vector) -> Vector:
        x = self.full_state(t, z)
        rate = self._rate
        rate[: self.size] = self.evaluation.derivative(t, x)
        rate[self._position] = rate[self._velocity] = 0.0
        if self.massless:
            rate[self._coils] = rate[self._coil_rates] = 0.0
        self.energies.powers(t, x, self.evaluation.u, self.evaluation.y, rate[self.size :])
        return rate

    def _find_relative_acceleration(self, load: float, t: float, x: Vector) -> float:
        """Acceleration of the cam's surface less that of the follower under `load`."""
        e = self.evaluation
        e.u[self._load] = load
        dx = e.derivative(t, x)
        y = e.y
        bend = y[self._radius] - self._base - y[self._lift]
        slope, across = self._slopes
        # psi'' holds that of the tilt's lag, slope slope_across/2.
        lag = dx[slope + 1] * x[across] + 2.0 * x[slope + 1] * x[across + 1] + x[slope] * dx[across + 1]
        turning = self._ratio * e.u[self._drive] + dx[self._twist_rate] - 0.5 * lag
        surface = (
            bend * y[self._speed] ** 2
            + (y[self._offset] - x[self._across]) * turning
            + dx[self._bending_rate]
        )
        return float(surface - dx[self._velocity])

    def _solve_load(self, t: float, x: Vector) -> None:
        """Leave the evaluation at the load for which the relative acceleration vanishes."""
        low, high = 0.0, TRIAL_LOAD
        g_low = self._find_relative_acceleration(low, t, x)
        for _ in range(SECANT_STEPS):
            g_high = self._find_relative_acceleration(high, t, x)
            if g_high == g_low:
                return
            load = high - g_high * (high - low) / (g_high - g_low)
            close = abs(load - high) <= LOAD_TOLERANCE * (TRIAL_LOAD + abs(load))
            low, g_low, high = high, g_high, load
            if close or not np.isfinite(load):
                return
        raise ModelError(f"adherence: no contact load found at t = {t:g} s")


def _find_only(system: System, component: str) -> str:
    """The name of the system's one instance of a component."""
    found = [name for name, instance in system.instances.items() if instance.component.name == component]
    if len(found) != 1:
        raise ModelError(
            f"adherence: the system has {len(found)} components {component}: must be exactly 1 (solve each "
            "valve train by itself)"
        )
    return found[0]


def _give_load(system: System, contact: str) -> System:
    """The same system with its contact in adherence form."""
    instances = dict(system.instances)
    given = instances[contact]
    instances[contact] = replace(given, parameters={**given.parameters, "load_is_given": 1.0})
    return system.with_instances(instances)
