"""A consistent static start: the state in which everything that can rest is at rest."""

import numpy as np
from scipy.integrate import BDF
from scipy.optimize import least_squares, root
from threadpoolctl import threadpool_limits

from ..core.evaluation import Evaluation, Interpreted
from ..core.quantities import Vector
from ..core.system import ModelError, System
from .problem import find_central_jacobian, find_jacobian

# The Newton step that remains, in nominal sizes, at which an equilibrium counts as found.
CLOSE = 1e-9
POLISHING_STEPS = 4
# Newton's steps only halve the distance where a force begins at a contact that just touches.
SLOW_STEPS = 40
# Of a search for least squares, where Newton's method has not found the rest.
MOST_TRIALS = 60
# Farther than so many nominal sizes a root of the rates may be another than that to which the motion leads.
FAR = 10.0
# Of pseudo-transient continuation: the first step (s), the last one, longer than any motion, the growth; most
# steps, most Newton steps in one, the change in nominal sizes at which these end, and that which is astray.
FIRST_STEP, LAST_STEP, GROWTH = 1e-5, 1e4, 2.0
SETTLING_STEPS, MOST_CORRECTIONS, SETTLED, ASTRAY = 200, 12, 1e-3, 10.0
# Of the motion to the rest while the cam stands: its duration (s), tolerance and most steps.
DURATION, ROUGH, MOST_STEPS = 1.0, 1e-4, 50_000
# The velocity of a lift is that of its change in this time (s), in which no cam turns noticeably.
SHORT = 1e-7
# A follower (m/s) that is at rest: 20 um of run-out move it half as fast at 1000 r/min, ramps ten times so.
SLOW_FOLLOWER = 2e-3
# A positive state that changes by less of itself in a second is at rest.
SLOW = 1e-6


def equilibrium(system: System, t: float = 0.0) -> Vector:
    """State in which dx/dt = 0 for all states that rest (`Component.resting`).

    A state whose rate vanishes whatever the others are (a film without entrainment, the twist of a rigid
    shaft) is not determined and keeps its start, as do internal states. Positive states stay positive. The
    cam should stand on its base circle at `t`, where a follower at rest is consistent. ModelError if there
    is no equilibrium.
    """
    # Threads of a linear algebra this small wait for each other ten times longer than they compute.
    with threadpool_limits(limits=1, user_api="blas"):
        return _Rest(system, t).find()


def list_moving_cams(system: System, t: float, x: Vector) -> list[str]:
    """A line for each cam that moves its follower at `t`: there a follower at rest is no equilibrium."""
    evaluation, found = Interpreted(system), []
    ahead = x + SHORT * evaluation.derivative(t, x)
    later = evaluation.outputs(t + SHORT, ahead).copy()
    evaluation.outputs(t, x)
    for name, instance in system.instances.items():
        component = instance.component
        values = component.inputs.named(evaluation.u[system.inputs.of(name)])
        values |= component.outputs.named(evaluation.y[system.outputs.of(name)])
        if "cam_lift" not in values:
            continue
        after = component.outputs.named(later[system.outputs.of(name)])
        velocity = (after["cam_lift"] - values["cam_lift"]) / SHORT
        if abs(velocity) > SLOW_FOLLOWER:
            found.append(
                f"{name}: at t = {t:g} s its cam lifts by {1e3 * values['cam_lift']:.3g} mm and moves the "
                f"follower at {velocity:.3g} m/s, which equilibrium begins at rest: begin on the base circle "
                "(phase)"
            )
    return found


def implausible(system: System) -> list[str]:
    """Parameters and inputs of implausible size, with the reason."""
    found = []
    for name, instance in system.instances.items():
        values = {**instance.parameters, **instance.inputs}
        for field in (*instance.component.parameters.fields, *instance.component.inputs.fields):
            value = values.get(field.name, field.start)
            if doubt := field.quantity.doubt(value):
                found.append(f"{name}.{field.name} = {value:g} {field.quantity.unit}: {doubt}")
    return found


class _Rest:
    """The rates of the states that rest, as a function of these states in nominal scaling.

    A state that must be positive varies by its logarithm.
    """

    def __init__(self, system: System, t: float) -> None:
        self.system, self.t = system, t
        self.evaluation, self.differentiate = Evaluation(system), find_jacobian
        self.x0 = system.x0.copy()
        self.positive = np.zeros(system.state.size, dtype=bool)
        resting = np.zeros(system.state.size, dtype=bool)
        for name, instance in system.instances.items():
            component, part = instance.component, system.state.of(name)
            names = set(component.state.variables if component.resting is None else component.resting)
            resting[part] = [item in names for item in component.state.names]
            self.positive[part] = [item.quantity.positive for item in component.state.fields]
        self.index = np.flatnonzero(resting)
        self.keep_undetermined()

    def keep_undetermined(self) -> None:
        """Leave out the states whose rates nothing changes."""
        while self.index.size:
            self.scale = np.ones(self.index.size)
            effect = np.max(np.abs(self.jacobian(np.zeros(self.index.size))), axis=1)
            if np.all(effect > 0.0):
                # Rates differ by many orders: each is measured by what the states' nominal sizes do to it.
                self.scale = effect
                break
            # Without these states others may lose what determines them (a rigid shaft's twist the film).
            self.index = self.index[effect > 0.0]

    def keep_slow(self) -> None:
        """Leave out positive states that then rest wherever they are: films without entrainment.

        On the way to the rest of a lever its film would otherwise follow a velocity that is rounding.
        """
        every, positive = self.index, self.positive[self.index]
        if not positive.any() or positive.all():
            return
        self.index = every[~positive]
        self.keep_undetermined()
        x = self.state(self.solve())
        rates = np.abs(self.evaluation.derivative(self.t, x))
        slow = self.positive & (rates <= SLOW * np.abs(x))
        self.index = every[~slow[every]]
        self.keep_undetermined()

    def find(self) -> Vector:
        """The whole state at rest."""
        self.keep_slow()
        if self.index.size == 0:
            return self.x0
        found = self.solve()
        if not self.is_close(found):
            # A film that just fills a gap is so nearly undetermined that one-sided differences mislead.
            self.differentiate = find_central_jacobian
            near = self.approach(found)
            found = near if self.is_close(near) else self.approach(self.settle())
        if not self.is_close(found):
            what = f"no equilibrium found at t = {self.t:g} s: {self.worst(found)}"
            raise ModelError("; ".join([what, *self.list_moving_cams(), *implausible(self.system)]))
        return self.state(found)

    def solve(self) -> Vector:
        """The scaled states at rest, as far as they are found."""
        guess = np.zeros(self.index.size)
        found = root(self.residual, guess, method="hybr", tol=1e-13).x
        if not self.is_close(found):
            found = least_squares(
                self.residual, guess, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=MOST_TRIALS
            ).x
        found = self.polish(found)
        if not self.is_close(found) or np.max(np.abs(found)) > FAR:
            settled = self.approach(self.settle())
            found = settled if self.is_close(settled) else self.approach(found)
        if not self.is_close(found) and not self.list_moving_cams():
            found = self.approach(self.wait())
        return found

    def list_moving_cams(self) -> list[str]:
        return list_moving_cams(self.system, self.t, self.x0)

    def polish(self, scaled: Vector) -> Vector:
        for _ in range(POLISHING_STEPS):
            scaled = scaled - self.newton_step(scaled)
        return np.asarray(scaled)

    def approach(self, scaled: Vector) -> Vector:
        """Newton's steps until it is close, and on to rounding."""
        for _ in range(SLOW_STEPS):
            if self.is_close(scaled):
                break
            scaled = scaled - self.newton_step(scaled)
        return self.polish(scaled)

    def wait(self) -> Vector:
        """Where the motion itself leads from the start: no contact that opens and closes misleads it."""
        motion = BDF(
            lambda _, scaled: self.residual(scaled) * self.scale / self.sizes(scaled),
            0.0, np.zeros(self.index.size), DURATION, rtol=ROUGH, atol=1e-2 * ROUGH,
        )  # fmt: skip
        for _ in range(MOST_STEPS):
            if motion.status != "running":
                break
            motion.step()
        return np.asarray(motion.y)

    def sizes(self, scaled: Vector) -> Vector:
        """Of the states, by which the scaled ones change."""
        return np.where(self.positive, self.state(scaled), self.system.state.nominal)[self.index]

    def settle(self) -> Vector:
        """Where implicit steps that grow lead from the start: pseudo-transient continuation (Kelley and Keyes
        1998). It stays on the way of the motion, for what Newton's method overshoots: a journal that sinks in
        its bearing, a lever that would rest upside down too."""
        scaled, step = np.zeros(self.index.size), FIRST_STEP
        for _ in range(SETTLING_STEPS):
            ahead = self.step_implicitly(scaled, step)
            scaled, step = (scaled, step / GROWTH**2) if ahead is None else (ahead, step * GROWTH)
            if step > LAST_STEP:
                break
        return scaled

    def step_implicitly(self, scaled: Vector, step: float) -> Vector | None:
        """The end of a step of the implicit Euler method; None where Newton's method does not find it."""
        ahead = scaled.copy()
        for _ in range(MOST_CORRECTIONS):
            speeds = self.scale / self.sizes(ahead)
            left = np.eye(ahead.size) / step - speeds[:, None] * self.jacobian(ahead)
            right = speeds * self.residual(ahead) - (ahead - scaled) / step
            change = np.linalg.lstsq(left, right, rcond=None)[0]
            ahead += change
            farthest = np.max(np.abs(change))
            if farthest < SETTLED:
                return ahead
            if not farthest <= ASTRAY:
                return None
        return None

    def state(self, scaled: Vector) -> Vector:
        x = self.x0.copy()
        i = self.index
        x[i] += scaled * self.system.state.nominal[i]
        logarithmic = self.positive[i]
        # The clip keeps a wild trial finite.
        x[i[logarithmic]] = self.x0[i[logarithmic]] * np.exp(np.clip(scaled[logarithmic], -50.0, 50.0))
        return x

    def residual(self, scaled: Vector) -> Vector:
        rate = self.evaluation.derivative(self.t, self.state(scaled))[self.index] / self.scale
        return np.asarray(np.nan_to_num(rate, nan=1e30, posinf=1e30, neginf=-1e30))

    def jacobian(self, scaled: Vector) -> Vector:
        return self.differentiate(self.residual, scaled, np.ones(scaled.size))

    def newton_step(self, scaled: Vector) -> Vector:
        return np.asarray(np.linalg.lstsq(self.jacobian(scaled), self.residual(scaled), rcond=None)[0])

    def is_close(self, scaled: Vector) -> bool:
        step = self.newton_step(scaled)
        left = self.residual(scaled) - self.jacobian(scaled) @ step
        return bool(np.all(np.abs(step) <= CLOSE * (1.0 + np.abs(scaled))) and np.all(np.abs(left) <= CLOSE))

    def worst(self, scaled: Vector) -> str:
        k = int(np.argmax(np.abs(self.residual(scaled))))
        name = self.system.state.names[self.index[k]]
        rate = self.evaluation.derivative(self.t, self.state(scaled))[self.index[k]]
        return f"{name} still changes at {rate:.3g} per second"
