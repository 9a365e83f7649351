"""Newton: the end values of a macro step by Newton's method, with sensitivities measured by rollback."""

from dataclasses import dataclass

import numpy as np

from models.core.quantities import Vector

from ..engine.coupling import Coupling
from ..engine.sweeps import JACOBI
from .acceleration import Acceleration
from .interface import bind_interface
from .iteration import Implicit, converge
from .parts import step_in_parts
from .protocol import MasterStep

# Perturbation of an end value, in nominal sizes: far above what participants integrate to (1e-10), and far
# below where they bend.
PERTURBATION = 1e-5
# The Jacobian serves for steps within this factor of the one it was measured in,
SERVES_WITHIN = 1.5
# and as long as it converges in that many iterations.
SLOW = 6


@dataclass(frozen=True)
class Newton(Implicit):
    """As `iterated`, with the interface's Jacobian: for couplings where fixed points diverge or creep.

    The Jacobian is measured once (each participant advances once for every value, and rate, that it is
    given) and serves for many macro steps. Jacobi sweeps; other options as those of `iterated`.
    """

    iterate: tuple[str, ...] = ()

    def step(self, coupling: Coupling, time: float, step: float) -> MasterStep:
        def iterate(part: tuple[int, ...], predicted: Vector) -> int:
            key = f"jacobian {part[0]}"
            held = coupling.state.warm_starts.get(key)
            if held is None or not 1.0 / SERVES_WITHIN < step / held["step"] < SERVES_WITHIN:
                held = {"step": step, "matrix": measure_jacobian(coupling, part, time, step)}
            iterations = converge(
                coupling, part, time, step, JACOBI, JACOBI,
                lambda warm_start, step: Correction(held["matrix"]), self, predicted,
            )  # fmt: skip
            coupling.state.warm_starts[key] = held if iterations <= SLOW else None
            return iterations

        return step_in_parts(coupling, (), self.iterate, time, step, iterate)


class Correction(Acceleration):
    """Newton's correction of a guess v for v = G(v): v + (1 - J)^-1 (G(v) - v)."""

    def __init__(self, jacobian: Vector) -> None:
        self._jacobian = jacobian

    def next(self, guess: Vector, result: Vector) -> Vector:
        matrix = np.eye(len(self._jacobian)) - self._jacobian
        return np.asarray(guess + np.linalg.lstsq(matrix, result - guess, rcond=1e-12)[0])


def measure_jacobian(coupling: Coupling, part: tuple[int, ...], time: float, step: float) -> Vector:
    """d(end values after a Jacobi sweep) / d(end values that its signals assume), in the interface's units.

    The participants end where they were, and the signals are the extrapolation, as before.
    """
    interface = bind_interface(coupling, part, step)
    end = time + step
    arrived, signals = coupling.state.arrived.copy(), coupling.signals.copy()
    guess = interface.predict(step)
    with coupling.points.rollback(part) as roll_back:
        interface.assume(guess, end)
        coupling.sweep(JACOBI, part, time, step)
        result = interface.gather()
        found = coupling.state.arrived.copy()
        matrix = np.zeros((len(guess), len(guess)))
        for j in range(len(guess)):
            source = interface.find_source(j)
            fed = tuple(i for i in part if source in coupling.wiring.columns[i])
            roll_back()
            perturbed = guess.copy()
            perturbed[j] += PERTURBATION
            interface.assume(perturbed, end)
            coupling.sweep(JACOBI, fed, time, step)
            matrix[:, j] = (interface.gather() - result) / PERTURBATION
            coupling.state.arrived[:] = found
        roll_back()
    coupling.state.arrived[:], coupling.signals[:] = arrived, signals
    return matrix
