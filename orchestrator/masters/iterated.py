"""Iterated: the macro step is repeated from its start until the exchanged end values agree."""

from dataclasses import dataclass

from models.core.quantities import Vector

from ..engine.coupling import Coupling
from ..engine.sweeps import GAUSS_SEIDEL, JACOBI
from ..errors import one_of
from .acceleration import ACCELERATIONS
from .iteration import Implicit, converge
from .parts import step_in_parts
from .protocol import MasterStep


@dataclass(frozen=True)
class Iterated(Implicit):
    """Fixed-point iteration with rollback: a Jacobi sweep as predictor, then Gauss-Seidel sweeps.

    Inputs are interpolated over the step between known values and the end values of the last sweep:
    `extrapolation` is the degree of that signal (hold: the end value; hermite: values and rates at both
    ends). Converged when the end values are right to `tolerance` of their nominal size, as far as the
    contraction tells. `acceleration` is none, aitken, anderson or quasi_newton. Only what is strongly
    connected is iterated; `iterate` names a smaller part, whose other connections are then explicit.
    """

    acceleration: str = "anderson"
    order: tuple[str, ...] = ()
    iterate: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.acceleration not in ACCELERATIONS:
            raise ValueError(
                f"acceleration = {self.acceleration!r}: {one_of(ACCELERATIONS, self.acceleration)}"
            )

    def step(self, coupling: Coupling, time: float, step: float) -> MasterStep:
        def iterate(part: tuple[int, ...], predicted: Vector) -> int:
            return converge(
                coupling, part, time, step, JACOBI, GAUSS_SEIDEL,
                ACCELERATIONS[self.acceleration], self, predicted,
            )  # fmt: skip

        return step_in_parts(coupling, self.order, self.iterate, time, step, iterate)
