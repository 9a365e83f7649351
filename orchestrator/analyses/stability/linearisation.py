"""Linearisation of participants at instants of a trajectory, and the coupled system about each instant.

Components are linearised by their equations, FMUs by directional derivatives, others by their responses.
"""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from models.core.quantities import Layout, Vector
from models.core.system import Instance, ModelError, Port, System
from models.monolithic.trajectory import Trajectory

from ...errors import ParticipantError, Set
from ...participants.protocol import Participant
from ...participants.reopened import Reopened
from ...participants.wrapping import Transformed as transformed
from ...run.plan import ParticipantPlan
from ...scenario import Scenario, ScenarioError
from ...scenario.capabilities import list_foreign
from .linear import ROWS, Linear, compute_eigenvalues
from .responses import FRESH, SAMPLES, SAVED, Responses
from .trajectory import (
    NotLinearError,
    ParticipantLinearisation,
    list_connected_inputs,
    list_continuous_outputs,
)

NO_PARTICIPANTS: Mapping[str, ParticipantLinearisation] = {}
# Half the span of a central difference, as a share of the nominal size (or of the value, if larger):
# rounding, 1e-16 over it, and truncation, its square, are below 1e-9.
SHARE = 1e-6
# A variable has a kink if its one-sided slopes differ by more than this share of the larger one; their
# truncation is of the order of SHARE.
KINK = 1e-2
# Relative rounding of a kernel's result: a thousand roundings of a double.
ROUNDING = 1e-13
# Instants of the trajectory at which a system is linearised.
POINTS = 12
# Steps of an FMU without saved states, to come to these instants again: some minutes.
MOST_REPEATED = 2e6


def linearise(instance: Instance, t: float, x: Vector, u: Vector, outputs: Collection[str]) -> Linear:
    """Linearise the instance about (t, x, u), with zero rows for outputs other than `outputs`.

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
    by_state, kinks = _compute_slopes(lambda v: np.where(rows, rates(v, u), 0.0), x, c.state)
    by_input, more = _compute_slopes(lambda v: np.where(rows, rates(x, v), 0.0), u, c.inputs)
    n = c.state.size
    return Linear(by_state[:n], by_input[:n], by_state[n:], by_input[n:], c.state.nominal, (*kinks, *more))


def _compute_slopes(
    function: Callable[[Vector], Vector], at: Vector, layout: Layout
) -> tuple[Vector, list[str]]:
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
        # Where one side is not finite (a film below zero), the other one is used.
        forward = np.where(np.isfinite(forward), forward, backward)
        backward = np.where(np.isfinite(backward), backward, forward)
        steeper = np.where(np.abs(forward) >= np.abs(backward), forward, backward)
        rounding = ROUNDING * np.abs(middle) / reach
        kinked = np.abs(forward - backward) > KINK * np.abs(steeper) + rounding
        slopes[:, j] = np.where(kinked, steeper, 0.5 * (forward + backward))
        if np.any(kinked):
            kinks.append(item.name)
    return np.nan_to_num(slopes), kinks


class Directional(ParticipantLinearisation):
    """Of an FMU that gives directional derivatives, by these.

    At a kink they are those of the active branch. The model description says which derivatives of its inputs
    the FMU follows, or its answers to the calls that set them.
    """

    def __init__(self, name: str, participant: Participant, system: System) -> None:
        super().__init__(name, participant, system)
        assert participant.abilities.derivatives
        self._fmu = participant.abilities.derivatives
        self._states = self._fmu.find_states([*self.input_names, *self.output_names]) or ()

    def about(self, trajectory: Trajectory, row: int, outputs: Collection[str]) -> Linear:
        self._advance_to(trajectory, row)
        self._inputs[:] = 0.0
        self._inputs[0] = self._values[row]
        self._participant.write()
        states, rates = [state for state, _, _ in self._states], [rate for _, rate, _ in self._states]
        unknown, known = [*rates, *self.output_names], [*states, *self.input_names]
        try:
            found = self._fmu.jacobian(unknown, known)
        except ParticipantError as error:
            raise ModelError(
                error,
                "give a copy of the FMU whose modelDescription.xml does not say that it provides directional "
                "derivatives, or ask who made it",
            ) from None
        n, followed = len(states), np.ones((ROWS, len(self.input_names)))
        taken = self._fmu.get_followed()
        followed[: len(taken)] = taken
        scale = np.array([nominal for _, _, nominal in self._states])
        linear = Linear(found[:n, :n], found[:n, n:], found[n:, :n], found[n:, n:], scale)
        return self._expand(linear, followed, [], outputs)

    @property
    def description(self) -> tuple[str, str]:
        return "By their directional derivatives", self.name


@dataclass(frozen=True, eq=False)
class Point:
    """All participants, linearised about one instant of the trajectory."""

    time: float
    system: System
    linears: Mapping[str, Linear]

    @cached_property
    def growth(self) -> float:
        """The largest growth rate (1/s) of the monolithic system, at least zero."""
        values = compute_eigenvalues(self.matrix)
        return max(0.0, float(np.max(values.real, initial=0.0)))

    @cached_property
    def _modes(self) -> Vector:
        """Eigenvalues (1/s) of each participant alone."""
        return np.concatenate([compute_eigenvalues(linear.A) for linear in self.linears.values()])

    def fastest(self, decay: float) -> float:
        """The fastest oscillation (rad/s) of a lone participant that decays no faster than `decay` (1/s)."""
        lasting = self._modes[self._modes.real > -decay]
        return float(np.max(np.abs(lasting.imag), initial=0.0))

    @cached_property
    def matrix(self) -> Vector:
        """dx/dt = matrix x of the monolithic system."""
        s = self.system
        A, B, C, D = (_join_blocks([getattr(self.linears[n], part) for n in s.instances]) for part in "ABCD")
        connect = np.zeros((s.inputs.size, s.outputs.size))
        connect[s.target_index, s.source_index] = 1.0
        loop = np.eye(s.outputs.size) - D @ connect
        outputs = np.linalg.solve(loop, C)
        return np.asarray(A + B @ connect @ outputs)

    @property
    def kinks(self) -> list[str]:
        """Variables that have a kink here."""
        return [f"{name}.{item}" for name, linear in self.linears.items() for item in linear.kinks]


def _join_blocks(parts: Sequence[Vector]) -> Vector:
    rows, columns = (sum(part.shape[axis] for part in parts) for axis in (0, 1))
    whole = np.zeros((rows, columns))
    i = j = 0
    for part in parts:
        whole[i : i + part.shape[0], j : j + part.shape[1]] = part
        i, j = i + part.shape[0], j + part.shape[1]
    return whole


def linearise_at(
    system: System,
    trajectory: Trajectory,
    row: int,
    watched: Sequence[Port],
    participants: Mapping[str, ParticipantLinearisation] = NO_PARTICIPANTS,
) -> Point:
    """Linearise the system about an instant of its trajectory: by `participants`, the others by equations."""
    time = float(trajectory.times[row])
    wanted = {c.source for c in system.connections} | set(watched)
    linears = {}
    for name, instance in system.instances.items():
        outputs = {port.variable for port in wanted if port.instance == name}
        if name in participants:
            linears[name] = participants[name].about(trajectory, row, outputs)
        else:
            x, u = trajectory.states[name][row], trajectory.inputs[row][system.inputs.of(name)]
            linears[name] = linearise(instance, time, x, u, outputs)
    return Point(time, system, linears)


def linearise_points(
    system: System,
    trajectory: Trajectory,
    rows: Sequence[int],
    watched: Sequence[Port],
    participants: Mapping[str, ParticipantLinearisation] = NO_PARTICIPANTS,
) -> tuple[list[Point], list[str]]:
    """Linearise about several instants, in ascending order; also return why instants were left out.

    Raises NotLinearError if none is left.
    """
    points, left = [], []
    for row in rows:
        try:
            points.append(linearise_at(system, trajectory, row, watched, participants))
        except NotLinearError as error:
            left.append(error)
    if not points:
        raise left[0]
    return points, list(dict.fromkeys(map(str, left)))


@contextmanager
def open_linearisations(
    scenario: Scenario, system: System, participants: Mapping[str, ParticipantPlan]
) -> Iterator[dict[str, ParticipantLinearisation]]:
    """Open what is not linearised by its equations: by directional derivatives, or else by its responses.

    Participants live as long as the block. Raises ScenarioError for one that has a field, and for one that
    cannot save its state if the repetition of its run would cost too much.
    """
    foreign = list_foreign(scenario)
    with ExitStack() as stack:
        opened: dict[str, ParticipantLinearisation] = {}
        for name, table in scenario.components.items():
            component = system.instances[name].component
            ode = component.ode
            if not ode and component.implicit:
                # Measured on valve-train-ehl at 4 us: residuals of 54 to 878 %, and limits far too low.
                formula = Set(f"components.{name}.component", "ehl_contact")
                raise ScenarioError(
                    f"components.{name}: its coupling cannot be analysed: the errors of its field's steps "
                    "(field_tolerance) hide the responses to small changes",
                    ("take a film formula in its place, ", formula),
                )
            if ode and not foreign and not table.file:
                continue
            plan, instance = participants[name], system.instances[name]
            unit = plan.open_bare(name, instance)
            exchanged = [*list_connected_inputs(name, system), *list_continuous_outputs(name, system)]
            derivatives = None if plan.linear else unit.abilities.derivatives
            if derivatives and derivatives.find_states(exchanged) is not None:
                stack.callback(unit.close)
                opened[name] = Directional(name, unit, system)
                continue
            returns = SAVED
            if not unit.abilities.restorable:
                unit.close()
                check_repetition(scenario, name, len(list_connected_inputs(name, system)))
                unit = Reopened(partial(plan.open_bare, name, instance))
                returns = FRESH
            if plan.linear:
                unit = transformed(unit, plan.linear)
            stack.callback(unit.close)
            opened[name] = Responses(name, unit, system, scenario.macro_step, returns)
        yield opened


def check_repetition(scenario: Scenario, name: str, inputs: int) -> None:
    """ScenarioError if a participant without saved states would have to make too many steps.

    Every response begins with a fresh instance that makes the run up to its instant again: on average half
    of the macro steps, for two responses by input and two more, at each instant.
    """
    table = scenario.components[name]
    responses = POINTS * (2 * inputs + 2)
    steps = responses * (0.5 * scenario.stop_time / scenario.macro_step + SAMPLES)
    if steps > MOST_REPEATED:
        raise ScenarioError(
            f"components.{name}.participant: {table.participant} cannot save its state "
            f"(canGetAndSetFMUstate = false), so {responses} fresh instances would make {steps:.2g} steps to "
            f"come to the instants of the analysis; at most {MOST_REPEATED:.0e} are made: shorten stop_time, "
            "or give an FMU that can"
        )
