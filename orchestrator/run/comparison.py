"""The coupled run against the monolithic reference, variable by variable."""

from collections.abc import Mapping
from dataclasses import dataclass

from models.core.difference import Difference, difference, time_weights
from models.core.quantities import Vector


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


def compare(
    times: Vector,
    coupled: Mapping[str, Vector],
    reference: Mapping[str, Vector],
    uncertainty: Mapping[str, Difference],
    nominal: Mapping[str, float],
    tolerance: Mapping[str, float],
    orders: Mapping[str, float] | None = None,
) -> Errors:
    """The error of every variable in `coupled`, whose values are, like the reference's, at `times`.

    Records count by the time that they stand for.
    """
    weights = time_weights(times)
    errors: Errors = {}
    for name, values in coupled.items():
        found = difference(values, reference[name], nominal[name], weights)
        errors[name] = VariableError(
            max_abs=found.max_abs,
            rms=found.rms,
            relative_rms=found.relative_rms,
            uncertainty=uncertainty[name],
            tolerance=tolerance.get(name),
            order=orders[name] if orders else None,
        )
    return errors


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
