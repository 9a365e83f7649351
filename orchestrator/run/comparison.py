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
from ..scenario.fmu_limits import FmuLimits
from ..scenario.origin import names_file

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
        """True without a tolerance. With one, error and reference's uncertainty must both be within it."""
        if self.tolerance is None:
            return True
        return self.relative_rms <= self.tolerance and self.uncertainty.relative_rms <= self.tolerance


Errors = dict[str, VariableError]


def verdict(errors: Errors) -> tuple[bool, str]:
    """Whether all tolerances are kept, and a sentence that names what is not."""
    failed = []
    for name, error in errors.items():
        own = error.uncertainty.relative_rms
        if error.tolerance is None or error.within:
            continue
        if own <= error.tolerance or error.relative_rms > error.tolerance + own:
            failed.append(f"{name}: relative RMS error {error.relative_rms:.2g} > {error.tolerance:g}")
        else:
            lower = "lower reference.tolerance, or with a pressure field reference.step"
            remedy = lower if error.order is None else "reduce macro_step"
            failed.append(
                f"{name}: the reference's own uncertainty {own:.2g} is above the tolerance "
                f"{error.tolerance:g} ({remedy})"
            )
    if failed:
        return False, "outside the tolerance: " + "; ".join(failed)
    return True, "within the tolerance"


# Held signals have order 1. An error that falls with a clearly lower power of the steps is not theirs.
LEAST_ORDER = 0.8
# By these the steps are divided.
ROUND = [factor * 10**power for power in range(4) for factor in (2, 5, 10)]


def advise(scenario: Scenario, errors: Errors, orders: Mapping[str, float], solvers: Sequence[str]) -> Words:
    """The likeliest cause of these too large errors, and what helps, for a verdict.

    The `orders` are the measured powers of the steps with which errors fall. One that does not fall is an
    error of the FMUs' own `solvers`.
    """
    least = LEAST_ORDER if solvers else 0.0
    falling = {name: orders[name] for name in errors if orders.get(name, math.nan) > least}
    blamed = _blame_solvers(errors, orders, solvers)
    if not errors or (orders and not falling):
        return blamed
    return join(blamed, "; ", _advise_on_coupling(scenario, errors, falling))


def _blame_solvers(errors: Errors, orders: Mapping[str, float], solvers: Sequence[str]) -> str:
    """What of these errors halved steps leave; empty if none stays."""
    stay = [name for name in errors if solvers and orders.get(name, math.nan) <= LEAST_ORDER]
    if not stay:
        return ""
    left = ", ".join(f"{100.0 * 2.0 ** -orders[name]:.0f} % of the error of {name}" for name in stay)
    return (
        f"; halved steps leave {left}, so the own solvers of {', '.join(solvers)} are the likely cause: "
        "interface = 'model_exchange' integrates their equations here instead"
    )


def _advise_on_coupling(scenario: Scenario, errors: Errors, falling: Mapping[str, float]) -> Words:
    """Steps, and signals, that keep the tolerance; `falling` has the orders of errors that steps reduce."""
    found, excess = "", 10.0
    if falling:
        shares = {name: errors[name].relative_rms / (errors[name].tolerance or math.inf) for name in falling}
        name = max(falling, key=shares.__getitem__)
        excess = 2.0 * shares[name]
        found = f"the error of {name} falls with the power {falling[name]:.2g} of the steps, so the "
        found += "coupling is its cause; "
        excess = excess if scenario.step_control else excess ** (1.0 / falling[name])
    parts = next((factor for factor in ROUND if factor >= excess), ROUND[-1])
    shorter = (
        Set("step_control.relative", float(f"{scenario.step_control.relative / parts:.6g}"))
        if scenario.step_control
        else Set("macro_step", f"{scenario.macro_step / parts:.6g} s")
    )
    limits, used = FmuLimits(scenario), scenario.build_master().degree
    useful = limits.useful_degree if limits.followed or not used else 0
    signals: Words = ", or signals of a higher order: ", Set("master.extrapolation", list(DEGREES)[useful])
    whole = [(Set(f"components.{name}.interface", "model_exchange"), ", or ") for name in limits.integrable]
    return found, *whole, "shorter steps: ", shorter, signals if useful > used else ""


def describe_largest(errors: Errors) -> str:
    """The largest error of the variables with a tolerance, by its share of that, in words; empty without."""
    judged = {name: error for name, error in errors.items() if error.tolerance}
    if not judged:
        return ""
    name = max(judged, key=lambda one: judged[one].relative_rms / (judged[one].tolerance or 1.0))
    error = judged[name]
    return (
        f"largest error: {error.relative_rms:.1e} in {name} (relative RMS, {error.tolerance:.0e} allowed); "
        f"the reference is known to {error.uncertainty.relative_rms:.0e}"
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
