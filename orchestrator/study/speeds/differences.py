"""Elasticities of figures of merit by differences: whole motions beside that of the scenario are compared.

For a share h of the parameter, D(h) = (g(1 + h) - g(1 - h))/(2 h) is the change of a figure g, and
(4 D(h) - D(2 h))/3 has an error of order h^4. Its distance from D(h) is published with it: it is large where
a figure is not smooth, as at the loss of contact.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from models.core.quantities import Vector
from models.core.words import tally
from models.monolithic.cycle import STEADY as LARGEST_CHANGE

from ...analyses import Parameter, Result
from ...assessment.friction.remarks import remark_friction
from ...errors import RunError
from ...reporter import Reporter
from ...scenario.files import put_parameters
from ...scenario.system import build_system, list_parameters
from ...scenario.values import Value
from ..files import plan_axis
from ..run import Where, run
from ..store import DONE
from ..subjects import NumberedSubject
from .figure_slopes import SPEED
from .subject import STEADY, SpeedSubject

# Of a parameter; of the solver; of a cycle. At a tenth of this share the noise of figures, 1e-7, makes errors
# of 1e-3; at ten times of it contacts' vibrations end in another phase.
SHARE, TOLERANCE, CLOSED = 1e-3, 1e-11, 1e-9
SHARES = (-2.0, -1.0, 1.0, 2.0)
SIDES = ("below", "above")
CASE = Parameter(0.0, "1", "number of the cycle: the first is that of the scenario itself")


@dataclass(frozen=True)
class SensitivitySubject(NumberedSubject):
    """The motions of a scenario beside that at a speed (rad/s), by the parameters "component.name"; `halved`:
    all of them in halved macro steps, too."""

    axis = CASE

    base: SpeedSubject
    speed: float
    parameters: tuple[str, ...]
    halved: bool = False

    @property
    def count(self) -> int:
        """Of the cases in one length of macro steps."""
        return 1 + len(SHARES) * len(self.parameters)

    @property
    def results(self) -> Mapping[str, Result]:
        return self.base.results

    def content(self) -> str:
        cycles = {"speed": self.speed, "parameters": self.parameters, "share": SHARE}
        return json.dumps(cycles) + self.base.content()

    def evaluate(self, values: Mapping[str, Value]) -> Mapping[str, float | str]:
        subject, speed = self.find_case(round(float(values["case"])))
        return subject.measure_at(speed, TOLERANCE, CLOSED)

    def find_case(self, case: int) -> tuple[SpeedSubject, float]:
        """The scenario and the speed (rad/s) of a cycle."""
        base, (finer, case) = self.base, divmod(case, self.count)
        if finer:
            base = replace(base, tables={**base.tables, "macro_step": 0.5 * base.scenario.macro_step})
        if not case:
            return base, self.speed
        which, step = divmod(case - 1, len(SHARES))
        name, factor = self.parameters[which], 1.0 + SHARE * SHARES[step]
        if name == SPEED:
            return base, self.speed * factor
        value = list_parameters(self.base.scenario)[name] * factor
        return replace(base, tables=put_parameters(base.tables, {name: value})), self.speed


def differentiate(table: Mapping[str, Vector], count: int) -> dict[str, tuple[Vector, ...]]:
    """By figure its elasticities dg/g over dp/p (count,), their errors, and those below and above; without
    those of a figure that is zero or unknown. `table`: the values of all cases.

    The error is the distance from D(h), a third of what both steps differ by, or half of what both sides
    differ by if that is more. Sides are of second order: of a smooth figure they differ by noise alone, the
    fourth difference over 2 h. Where one has no values, as beyond the edge of a range, the other one is the
    elasticity, and its distance from that of first order the error.
    """
    found: dict[str, tuple[Vector, ...]] = {}
    for name, values in table.items():
        if not values[0]:
            continue
        far_below, near_below, near_above, far_above = values[1:].reshape(count, len(SHARES)).T / values[0]
        near = (near_above - near_below) / (2.0 * SHARE)
        elasticity = (4.0 * near - (far_above - far_below) / (4.0 * SHARE)) / 3.0
        below, above = (
            side * (4.0 * one - two - 3.0) / (2.0 * SHARE)
            for side, one, two in ((-1.0, near_below, far_below), (1.0, near_above, far_above))
        )
        error = np.maximum(np.abs(elasticity - near), 0.5 * np.abs(above - below))
        for side, one, own in ((-1.0, near_below, below), (1.0, near_above, above)):
            alone = np.isnan(elasticity)
            error = np.where(alone, np.abs(own - side * (one - 1.0) / SHARE), error)
            elasticity = np.where(alone, own, elasticity)
        if np.isfinite(elasticity).any():
            found[name] = elasticity, error, below, above
    return found


def find_usable(cycles: xarray.Dataset, reporter: Reporter) -> NDArray[np.bool_]:
    """The cases with a steady cycle; RunError where the first, the scenario itself, has none."""
    done = cycles["status"].values == DONE
    usable = np.asarray(done & (cycles["change"].values <= LARGEST_CHANGE))
    if not done[0]:
        raise RunError(f"the scenario's own cycle was not found: {cycles['message'].values[0]}")
    if not usable[0]:
        raise RunError("the scenario has no steady cycle at this speed: there are no sensitivities")
    if unsteady := int(np.sum(done & ~usable)):
        reporter.line(
            f"{unsteady} cycles are not steady, see cycles.csv: their parameters have no sensitivities"
        )
    return usable


def compare_motions(
    subject: SensitivitySubject, store: Path, where: Where, reporter: Reporter, overwrite: bool
) -> xarray.Dataset:
    """The elasticities by differences of all cases; those in halved macro steps, if there are any, with what
    they differ by from the others in their errors."""
    count, last = len(subject.parameters), subject.count * (1 + subject.halved) - 1
    reporter.line(
        f"{last + 1} motions: {len(SHARES)} for each of {tally(count, 'parameter')}, and one"
        f"{', in two lengths of macro steps' if subject.halved else ''}"
    )
    name = subject.base.scenario.name
    description = f"{name}: motions beside that at {subject.speed:.6g} rad/s"
    plan = plan_axis(name, description, subject, "case", (0.0, float(last)), last + 1)
    status = run(plan, store, where, reporter, overwrite)
    with xarray.open_zarr(store) as stored:
        cycles = stored.load()
    found = _differentiate_cases(cycles.isel(case=slice(subject.count)), subject, reporter)
    if subject.halved:
        try:
            finer = _differentiate_cases(cycles.isel(case=slice(subject.count, None)), subject, reporter)
        except RunError as error:
            reporter.line(f"what macro steps cost is not known, as they cannot be halved: {error}")
        else:
            steps = abs(finer["elasticity"] - found["elasticity"])
            finer = finer.sel(figure=steps["figure"])
            found = finer.assign(error=finer["error"] + steps).assign_attrs(halved=1)
    friction = remark(subject.base, cycles.isel(case=0).data_vars)
    return found.assign_attrs(status=status, friction=friction)


def _differentiate_cases(
    cycles: xarray.Dataset, subject: SensitivitySubject, reporter: Reporter
) -> xarray.Dataset:
    usable = find_usable(cycles, reporter)
    values = {
        name: np.where(usable, cycles[name].values, np.nan)
        for name in subject.results
        if name not in STEADY and not name.endswith("_angle")
    }
    found = differentiate(values, len(subject.parameters))
    turning = {} if math.isnan(subject.speed) else {"speed": subject.speed}
    known = {name: (values[name][0], *one) for name, one in found.items()}
    return build_elasticities(known, subject.parameters, **turning, method="differences")


def build_elasticities(
    found: Mapping[str, tuple[Any, ...]], parameters: Sequence[str], **attributes: Any
) -> xarray.Dataset:
    """By figure its value, elasticities, their errors, and those below and above."""
    if not found:
        raise RunError(f"no figure of merit changes with {', '.join(parameters)}")
    value, *slopes = (np.array(column) for column in zip(*found.values(), strict=True))
    names, both = ("elasticity", "error", *SIDES), ("figure", "parameter")
    return xarray.Dataset(
        {"value": ("figure", value)} | {n: (both, one) for n, one in zip(names, slopes, strict=True)},
        {"figure": list(found), "parameter": list(parameters)},
        attributes,
    )


def remark(base: SpeedSubject, values: Mapping[str, Any]) -> str:
    """Lines to stand beside friction and torques."""
    return "\n".join(remark_friction(build_system(base.scenario), values))
