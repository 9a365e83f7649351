"""The figures of merit of a coupled run, or of the cycle that it settles in, where equations are unknown."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from rich.console import Console

from models.core.quantities import Vector
from models.monolithic.cycle import STEADY as LARGEST_CHANGE

from ...analyses import Result
from ...assessment.figures_of_merit import list_figures, measure
from ...assessment.merits import read_motion
from ...assessment.motion import Motion
from ...errors import Option, RunError
from ...reporter import Reporter, show_share
from ...run.plan import Plan, make_plan, open_participants
from ...run.simulation import Session
from ...scenario import Scenario, build_scenario
from ...scenario.files import put_parameters
from ...scenario.system import Builder, build_system, list_outputs, list_parameters, resolve
from ..scenario_subject import list_fmu_sums
from .subject import STEADY, SpeedSubject, describe_numbers, find_period

# Periods until a cycle is given up, and those in which the least change has to halve: of a cycle that is
# steady what is left is soon noise.
MOST, HALVING, STEADY_HALVING = 1000, 50, 8
# Of a quantity's nominal size: what is smaller is rounding. Of the largest value: a smaller mean is none. Of
# a time: two that are one.
ROUNDING, NO_MEAN, SAME = 1e-9, 1e-6, 1e-12


def is_coupled(scenario: Scenario) -> bool:
    """Whether a component's equations are unknown, so that only coupled runs tell its motion."""
    return any(table.resolve().opaque for table in scenario.components.values())


def describe_statistics(scenario: Scenario) -> dict[str, Result]:
    """Extremes and mean over time of each output of parts whose equations are unknown, of all parts where
    none has figures."""
    components = {name: table.resolve() for name, table in scenario.components.items()}
    known = any(list_figures(components))
    told = {name for name, component in components.items() if component.opaque or not known}
    return {
        f"{name}.{statistic}": Result(
            quantity.unit,
            f"{quantity.description}: {statistic} over time",
            display_unit=quantity.display_unit,
        )
        for name, quantity in list_outputs(scenario).items()
        if name.partition(".")[0] in told
        for statistic in ("minimum", "maximum", "mean")
    }


@dataclass(frozen=True)
class CoupledSubject(SpeedSubject):
    """A scenario by its coupled run (`running`), or by the cycle in which it settles: that of the `flywheel`
    at a speed, or without one ("") that of a `period` (s). `build` makes its FMUs. With `periods` it is the
    last of so many, so that all cycles to be compared have settled alike."""

    build: Builder = None  # type: ignore[assignment]  # given always; it comes after fields with defaults
    period: float = math.nan
    running: bool = False
    periods: int = 0

    @property
    def results(self) -> Mapping[str, Result]:
        return {**describe_numbers(self.scenario), **describe_statistics(self.scenario), **STEADY}

    def content(self) -> str:
        sums = "".join(list_fmu_sums(self.scenario))
        return f"{super().content()}{sums}# {self.flywheel} {self.period} {self.running} {self.periods}"

    @property
    def own_speed(self) -> float:
        """Of the flywheel, at its faster end (rad/s); nan without one."""
        values = list_parameters(self.scenario)
        return max((values[name] for name in self._ends), key=abs, default=math.nan)

    @property
    def _ends(self) -> list[str]:
        return [f"{self.flywheel}.{end}_speed" for end in ("initial", "final")] if self.flywheel else []

    def measure_at(self, speed: float, tolerance: float, steady: float) -> dict[str, float]:
        """The results at a speed (rad/s), which a run has at its faster end; it ends at the angle of the
        scenario's own.

        A cycle has come when a period changes no output by more than `steady`; masters have no `tolerance`.
        RunError where there is none.
        """
        scenario, period, factor = self.scenario, self.period, 1.0
        if self.flywheel:
            values, factor = list_parameters(scenario), speed / self.own_speed
            ends = {name: values[name] * factor for name in self._ends}
            scenario = build_scenario(put_parameters(self.tables, ends))
            period = find_period(build_system(scenario), speed)
        step, stop = scenario.macro_step / factor, scenario.stop_time / factor
        if self.running:
            period = stop
        else:
            step, stop = period / math.ceil(period / step - 1e-9), MOST * period
        scenario = scenario.model_copy(update={"macro_step": step, "stop_time": stop})
        plan = make_plan(resolve(scenario), self.build, Reporter(Console(quiet=True)), figures=False)
        times, rows, change, made = _couple(plan, period, steady, self.periods)
        columns = {"time": times, **dict(zip(plan.system.outputs.names, rows.T, strict=True))}
        motion = read_motion(plan.system, columns.__getitem__)
        found = {f"{part}.{name}": value.value for part, name, _, value in measure(motion)}
        return {**found, **self._list_statistics(motion), "change": change, "periods": float(made)}

    def _list_statistics(self, motion: Motion) -> dict[str, float]:
        """Means are by the trapezoidal rule. What turns in a cycle has none, nor what is near zero a mean."""
        found: dict[str, float] = {}
        for name in {name.rpartition(".")[0]: None for name in describe_statistics(self.scenario)}:
            values, times = motion.column(name), motion.times
            size = float(np.max(np.abs(values)))
            if not self.running and abs(values[-1] - values[0]) > LARGEST_CHANGE * size:
                continue
            mean = float(np.trapezoid(values, times) / (times[-1] - times[0]))
            found[f"{name}.mean"] = mean if abs(mean) > NO_MEAN * size else math.nan
            rows = values if self.running else np.concatenate([values[-3:-1], values, values[1:3]])
            found |= {f"{name}.minimum": -_find_peak(-rows), f"{name}.maximum": _find_peak(rows)}
        return found


def _find_peak(rows: Vector) -> float:
    """The largest value, between rows where their curvature is steady."""
    at = int(np.argmax(rows))
    bent = np.diff(rows[max(0, at - 2) : at + 3], 2)
    if bent.size < 3 or not 2.0 * np.max(bent) < np.min(bent):
        return float(rows[at])
    return float(rows[at] - (rows[at + 1] - rows[at - 1]) ** 2 / (8.0 * bent[1]))


def _couple(plan: Plan, period: float, steady: float, periods: int) -> tuple[Vector, Vector, float, int]:
    """Times and outputs at the macro steps of the last period, its largest change of an output, and how many
    there were; a run to `stop_time` is one."""
    outputs = plan.system.outputs.names
    quantities = [plan.quantities[name] for name in outputs]
    least = np.array([ROUNDING * one.nominal for one in quantities])
    # Angles turn, and times, as those of events, go on.
    whole = np.array([{"rad": 2.0 * math.pi, "s": period}.get(one.unit, math.inf) for one in quantities])
    changes: list[float] = []
    with open_participants(plan.system, plan.participants) as participants:
        steps, lines = plan.make_steps(), plan.side_lines
        session = Session(plan.system, participants, plan.master, steps, plan.stop_time, lines=lines)
        session.begin()
        times, rows = _march(session, period)
        if period >= plan.stop_time:
            return times, rows, 0.0, 1
        while len(changes) < MOST - 1:
            before, rows_before = times + period, rows
            times, rows = _march(session, (len(changes) + 2) * period)
            moved = rows - np.array([np.interp(times, before, column) for column in rows_before.T]).T
            moved -= np.where(np.isfinite(whole), whole, 0.0) * np.round(moved / whole)
            shares = np.max(np.abs(moved), axis=0) / np.maximum(np.max(np.abs(rows), axis=0), least)
            changes.append(float(np.max(shares)))
            last = STEADY_HALVING if changes[-1] <= LARGEST_CHANGE else HALVING
            stuck = len(changes) > last and min(changes[-last:]) > 0.5 * min(changes[:-last])
            if (len(changes) + 1 == periods) if periods else (stuck or changes[-1] <= steady):
                break
    if changes[-1] > LARGEST_CHANGE:
        name, change = outputs[int(np.argmax(shares))], f"{changes[-1]:.2g} of its size"
        raise RunError(
            f"no steady cycle: {name} still changes by {change} in the last of {len(changes) + 1} periods of "
            f"{period:.6g} s",
            "correct the period or the parameters",
            ("take the scenario's run with ", Option("run", True)),
        )
    return times, rows, changes[-1], len(changes) + 1


def _march(session: Session, end: float) -> tuple[Vector, Vector]:
    """Times and outputs from here on to the `end` (s)."""
    times, rows = [session.time], [session.read_outputs().copy()]
    while session.time < end * (1.0 - SAME):
        session.step()
        times.append(session.time)
        rows.append(session.read_outputs().copy())
        show_share(session.time / session.stop_time)
    return np.array(times), np.array(rows)
