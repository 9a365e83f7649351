"""The coupled run against the monolithic reference and the witness, variable by variable.

The witness of a run: the same valve train as rigid bodies with joints, solved with multipliers.

Components and reference share their equations, so that comparing them sees no error of the physics. The
witness shares none but the law of the contact and the lift of the cam.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from models.core.difference import Difference, difference, time_weights
from models.core.quantities import Vector
from models.core.system import System
from models.flywheel import PRESCRIBED
from models.multibody.witnessed_trains import DirectTrain, PushrodTrainOfParts, WitnessedTrain, find_train

from ..engine.signals import DEGREES
from ..errors import Set, Words, join
from ..scenario import Scenario, ScenarioError
from ..scenario.capabilities import describe_unsolvable, leaves_remainder, list_foreign
from ..scenario.fmu_limits import FmuLimits
from ..scenario.origin import names_file
from ..scenario.warnings import longest_sensible_step

if TYPE_CHECKING:
    from models.monolithic import Reference


@dataclass(frozen=True)
class VariableError:
    """The coupled run's error in one variable.

    `relative_rms` is the RMS error over the reference's spread (its size, where it is constant).
    `uncertainty` is the reference's own, as known from its two methods. `tolerance` is what the scenario
    allows for `relative_rms`, if anything. `order` is that of convergence, where runs with smaller steps are
    the reference.
    """

    max_abs: float
    rms: float
    relative_rms: float
    uncertainty: Difference
    tolerance: float | None = None
    order: float | None = None

    @property
    def below_uncertainty(self) -> bool:
        """The reference is not accurate enough to measure this error."""
        return self.rms < self.uncertainty.rms

    @property
    def within(self) -> bool:
        """Whether error and reference's uncertainty together are within the tolerance, if there is one."""
        return self.tolerance is None or self.relative_rms + self.uncertainty.relative_rms <= self.tolerance


Errors = dict[str, VariableError]


def verdict(errors: Errors) -> tuple[bool, str]:
    """Whether all tolerances are kept, and a sentence that names what is not, or what is not known."""
    failed, unknown = [], []
    for name, error in errors.items():
        own = error.uncertainty.relative_rms
        if error.tolerance is None or error.within:
            continue
        if error.relative_rms - own > error.tolerance:
            found = show_beside(error.relative_rms, error.tolerance)
            failed.append(f"{name}: relative RMS error {found} > {error.tolerance:g}")
        else:
            lower = "lower reference.tolerance, or with a pressure field reference.step"
            equations = "reduce macro_step, or where equations are known set reference.method = 'monolithic'"
            unknown.append(
                f"{name}: relative RMS error {error.relative_rms:.2g}, known to {own:.2g} only, "
                f"{error.tolerance:g} allowed ({lower if error.order is None else equations})"
            )
    said = {"outside the tolerance: ": failed, "not known to be within the tolerance: ": unknown}
    parts = [head + "; ".join(each) for head, each in said.items() if each]
    return not parts, "; ".join(parts) or "within the tolerance"


def show_beside(value: float, limit: float, kind: str = "g") -> str:
    """A value in two digits, or as many as leave it on its side of the limit."""
    texts = (f"{value:.{digits - (kind == 'e')}{kind}}" for digits in range(2, 18))
    return next((text for text in texts if (float(text) > limit) == (value > limit)), "nan")


# Held signals have order 1. An error that falls with a clearly lower power of the steps is not theirs alone.
LEAST_ORDER = 0.8
# An error is to be half of what is allowed: orders are not exact.
MARGIN = 2.0


def advise(scenario: Scenario, errors: Errors, orders: Mapping[str, float], solvers: Sequence[str]) -> Words:
    """The likeliest cause of these too large errors, and what helps, for a verdict.

    The `orders` are the measured powers of the steps with which errors fall; without a clear one no cause is
    named. Of the FMUs' own `solvers` errors are seen; one that does not fall is theirs.
    """
    falling = {name: orders[name] for name in errors if orders.get(name, math.nan) > LEAST_ORDER}
    stay = {name: orders[name] for name in errors if orders.get(name, math.nan) <= LEAST_ORDER}
    blamed = (_blame_solvers(stay, solvers) if solvers else _leave_open(scenario, stay)) if stay else ""
    if not errors or (orders and not falling):
        return blamed
    return join(blamed, "; ", _advise_on_coupling(scenario, errors, falling))


def _blame_solvers(stay: Mapping[str, float], solvers: Sequence[str]) -> str:
    """What of these errors halved steps leave."""
    left = ", ".join(f"{100.0 * 2.0**-order:.0f} % of the error of {name}" for name, order in stay.items())
    return (
        f"; halved steps leave {left}, so the own solvers of {', '.join(solvers)} are the likely cause: "
        "interface = 'model_exchange' integrates their equations here instead"
    )


def _leave_open(scenario: Scenario, stay: Mapping[str, float]) -> Words:
    """Errors without a clear order, where all runs have those of the FMUs' own solvers."""
    fell = ", ".join(f"the error of {name} falls with the power {order:.2g}" for name, order in stay.items())
    said = f"; {fell} of the steps: no clear order, so its cause is not known"
    foreign = {name: table.describe() for name, table in scenario.components.items() if table.third_party}
    if not foreign:
        return f"{said}; reduce macro_step"
    said += (
        f": the coupling, or the own solvers of {', '.join(foreign)}, whose errors change with the steps; "
    )
    offered = [name for name, about in foreign.items() if about.exchange and not about.integrated]
    inside: list[Words] = [(", ", Set(f"components.{name}.interface", "model_exchange")) for name in offered]
    if not describe_unsolvable(scenario, list_foreign(scenario)):
        inside.insert(0, (", ", Set("reference.method", "monolithic"), " tells them apart"))
    if offered:
        inside.append(" integrates equations here")
    return join(said, "reduce macro_step, or the tolerances of these solvers", *inside)


def _advise_on_coupling(scenario: Scenario, errors: Errors, falling: Mapping[str, float]) -> Words:
    """Steps, and signals, that keep the tolerance; `falling` has the orders of errors that steps reduce."""
    limits, used = FmuLimits(scenario), scenario.build_master().degree
    useful = limits.useful_degree if limits.followed or not used else 0
    # A held input gets the mean of its signal, of order 2 from degree 1 on.
    found, order = "", 1.0 + min(used, limits.useful_degree, 1 if limits.held_inputs else used)
    shares = {
        name: errors[name].relative_rms / (errors[name].tolerance or math.inf) for name in falling or errors
    }
    name = max(shares, key=shares.__getitem__)
    if falling:
        order = falling[name]
        found = f"the error of {name} falls with the power {order:.2g} of the steps, so the "
        found += "coupling is its cause; "
    excess = MARGIN * shares[name]
    shorter = (
        Set("step_control.relative", float(f"{scenario.step_control.relative / excess:.1g}"))
        if scenario.step_control
        else Set("macro_step", f"{divide(scenario, excess ** (1.0 / order)):.6g} s")
    )
    signals: Words = ", or signals of a higher order: ", Set("master.extrapolation", list(DEGREES)[useful])
    whole = [(Set(f"components.{name}.interface", "model_exchange"), ", or ") for name in limits.integrable]
    return found, *whole, "shorter steps: ", shorter, signals if useful > used else ""


def divide(scenario: Scenario, parts: float) -> float:
    """The longest macro step, of three digits where there is one, that is at least so many times shorter than
    the scenario's, divides its output step or else its stop time, and exchanges values often enough."""
    whole = scenario.output_step or scenario.stop_time
    longest = min(scenario.macro_step / parts, longest_sensible_step(scenario))
    digit = 10.0 ** (math.floor(math.log10(longest)) - 2)
    steps = (float(f"{count * digit:.3g}") for count in range(int(longest / digit * (1.0 + 1e-9)), 99, -1))
    return next(
        (step for step in steps if not leaves_remainder(whole, step)), whole / math.ceil(whole / longest)
    )


def describe_largest(errors: Errors) -> str:
    """The largest error of the variables with a tolerance, by its share of that, in words; empty without."""
    judged = {name: error for name, error in errors.items() if error.tolerance}
    if not judged:
        return ""
    name = max(judged, key=lambda one: judged[one].relative_rms / (judged[one].tolerance or 1.0))
    error = judged[name]
    found = show_beside(error.relative_rms, error.tolerance or 1.0, "e")
    return (
        f"largest error: {found} in {name} (relative RMS, "
        f"{error.tolerance:.0e} allowed); the reference is known to {error.uncertainty.relative_rms:.0e}"
    )


def largest_uncertainty(errors: Errors) -> float:
    """The reference's largest relative RMS uncertainty among variables with a tolerance."""
    return max((e.uncertainty.relative_rms for e in errors.values() if e.tolerance is not None), default=0.0)


# Of a step. The load is 4e8 N/m times what is left of it.
TOLERANCE = 1e-10
# Of a witness that contradicts: solved again with so many times the tolerance, it shows its own uncertainty.
ROUGHER = 10.0


# Relative RMS difference of reference and multibody model that is allowed: five times the largest that trains
# of the tests have, 2e-4 in the load of a valve that lands. Rebounds multiply small differences: where the
# methods do not know the motion so well, it is this many times their own uncertainty.
ALLOWED, FACTOR = 1e-3, 5.0
BLIND = "it shares the law of the contact with film and asperities, and the lift, and sees no error in them"


@dataclass(frozen=True)
class Side:
    """Least and largest value in the coupled run, the reference and the multibody model.

    The differences are relative RMS, as those of the coupled run against the reference.
    """

    coupled: tuple[float, float]
    reference: tuple[float, float]
    multibody: tuple[float, float]
    coupled_difference: float
    reference_difference: float


@dataclass(frozen=True)
class WitnessComparison:
    """What the witness says, by quantity; `drift` is the largest violation of a constraint (m or rad), and
    `known` the largest relative RMS uncertainty of reference and multibody model in these quantities."""

    method: str
    constraints: int
    freedoms: int
    drift: float
    wall_time_s: float
    quantities: Mapping[str, Side]
    known: float = 0.0

    @property
    def agrees(self) -> bool:
        """Whether the reference is as near to the multibody model as is `allowed` in every quantity."""
        return all(side.reference_difference <= self.allowed for side in self.quantities.values())

    @property
    def allowed(self) -> float:
        return max(ALLOWED, FACTOR * self.known)

    def describe_agreement(self) -> str:
        """The end of a verdict: whether it agrees, and what it cannot see."""
        if self.agrees and self.allowed > ALLOWED:
            return (
                f"; the multibody witness sees no error above {self.allowed:.1g} and can see none below: the "
                f"motion is sensitive, and known to {self.known:.1g} only ({BLIND})"
            )
        if self.agrees:
            return f"; the multibody witness agrees within {ALLOWED:g} ({BLIND})"
        apart = ", ".join(
            f"{name}: {side.reference_difference:.2g}"
            for name, side in self.quantities.items()
            if not side.reference_difference <= self.allowed
        )
        return (
            f"; the multibody witness contradicts the equations: relative RMS {apart} > {self.allowed:.2g} "
            f"({BLIND})"
        )


@names_file
def check_witness(scenario: Scenario, system: System) -> None:
    """Raise ScenarioError if a witness is asked for that does not know this system."""
    if scenario.reference.witness == "none":
        return
    train = _find_train(system)
    if not scenario.reference.enabled:
        _refuse("it stands beside the reference; set reference.enabled = true")
    if scenario.start != "equilibrium":
        _refuse("it begins at rest; set start = 'equilibrium'")
    drive = train.drive
    if drive.motion != PRESCRIBED or drive.initial_speed != drive.final_speed:
        _refuse("its drive turns at constant speed; set motion = 'prescribed' without a ramp")
    for (part, parameter), what in train.absent.items():
        if getattr(train.parameters[part], parameter) != 0.0:
            name = train.output(part, parameter)
            _refuse(f"it knows no {what}; set {name} to 0, or leave the witness out")
    driven = {str(connection.target) for connection in system.connections}
    for (part, variable), what in train.open.items():
        if (name := train.output(part, variable)) in driven:
            _refuse(f"it knows no {what}; leave out the connection to {name}, or the witness")
    for instance in train.names.values():
        layout, given = system.instances[instance].component.inputs, system.instances[instance].inputs
        for variable, value in given.items():
            name = f"{instance}.{variable}"
            if name not in driven and value != layout.field(variable).start:
                _refuse(f"it takes no constant inputs; leave out {name} = {value:g}, or the witness")


def _refuse(reason: str) -> NoReturn:
    raise ScenarioError(f"reference.witness = 'multibody': {reason}")


def _find_train(system: System) -> WitnessedTrain:
    train = find_train(system)
    if train is None:
        kinds = [instance.component.name for instance in system.instances.values()]
        known = "; or ".join(", ".join(kind.parts.values()) for kind in (DirectTrain, PushrodTrainOfParts))
        _refuse(
            f"it knows systems of {known}; this scenario has {', '.join(kinds)}. Take valve-train or "
            "qin2000-train, or one that extends them, or leave the witness out"
        )
    return train


def compare_witness(system: System, reference: Reference, coupled: Mapping[str, Vector]) -> WitnessComparison:
    """Solve the train of `system` as bodies with joints, at the instants of both, and compare."""
    from models.multibody.ida import solve_ida

    begun = clock.perf_counter()
    train = _find_train(system)
    times = np.append(0.0, reference.times[reference.times > 0.0])
    first = times.size - reference.times.size
    motion = solve_ida(train.build(), times, TOLERANCE)
    weights = time_weights(reference.times)
    observed = train.observe(motion)
    sides = {
        seen.name: _compare_sides(
            seen.find(coupled, reference), seen.find(reference, reference), seen.values[first:], weights
        )
        for seen in observed
    }
    known = [own.relative_rms for name, own in reference.uncertainty.items() if name in sides]
    witness = WitnessComparison(
        method=motion.method,
        constraints=len(motion.mechanism.constraint_names),
        freedoms=motion.mechanism.freedoms,
        drift=motion.drift.position,
        wall_time_s=clock.perf_counter() - begun,
        quantities=sides,
        known=max(known, default=0.0),
    )
    if witness.agrees:
        return witness
    rougher = train.observe(solve_ida(train.build(), times, ROUGHER * TOLERANCE))
    known += [
        difference(other.values, seen.values).relative_rms
        for other, seen in zip(rougher, observed, strict=True)
    ]
    return replace(witness, known=max(known, default=0.0), wall_time_s=clock.perf_counter() - begun)


def _compare_sides(coupled: Vector, reference: Vector, multibody: Vector, weights: Vector) -> Side:
    def span(values: Vector) -> tuple[float, float]:
        return float(np.min(values)), float(np.max(values))

    return Side(
        coupled=span(coupled),
        reference=span(reference),
        multibody=span(multibody),
        coupled_difference=difference(coupled, multibody, weights=weights).relative_rms,
        reference_difference=difference(reference, multibody, weights=weights).relative_rms,
    )
