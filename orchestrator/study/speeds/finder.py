"""Steady cycles of one train at many values of its parameters."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace

from models.core.quantities import Vector
from models.core.system import ModelError, System
from models.monolithic.compiled_march import CompiledMarch
from models.monolithic.cycle import STEADY as LARGEST_CHANGE
from models.monolithic.cycle import TOLERANCE, Cycle, Search, find_cycle, learn_slopes
from models.monolithic.problem import SystemProblem

from ...errors import MistakeError, one_of
from ...scenario.system import build_system, resolve_start
from .subject import SAMPLES, SpeedSubject, check_varied, find_period, measure_cycle

# Of a step of DOP853, whose figures are nearer to the motion's than those of CVODE at TOLERANCE.
NEAR_TOLERANCE = 1e-7


class CycleFinder:
    """Steady cycles of a scenario at values of its parameters, called "component.parameter", in SI units.

    The system is built and compiled once. The numbers that oils, tables and drawings give vary alone. The
    search at a speed begins with the last state of the scenario's own cycle there: what is found depends on
    nothing that was found before.
    """

    def __init__(
        self, subject: SpeedSubject, tolerance: float = TOLERANCE, steady: float = LARGEST_CHANGE
    ) -> None:
        self.subject = subject
        self.system = build_system(subject.scenario)
        self._tolerance, self._steady = tolerance, steady
        own = self.system.with_instances(self.system.instances)
        self._search = Search(SystemProblem(own, counts_energies=False))
        self._starts: dict[tuple[float, int], Vector] = {}
        self._near: dict[float, Search] = {}
        self._turning = [f"{subject.flywheel}.angle"]

    def find(
        self,
        values: Mapping[str, float],
        speed: float,
        start: Vector | None = None,
        samples: int | None = None,
    ) -> Cycle:
        """The cycle at this speed (rad/s) of the flywheel, from another state if `start` is given.
        MistakeError for an unknown parameter, ModelError where a value is out of range, or where no method
        goes through a period."""
        system, samples = self.change(values, speed), samples or SAMPLES
        if start is None:
            start = self._start(speed, samples)
        try:
            return self._find(system, speed, start, samples)
        except ModelError:
            return self.begin(values, speed, samples)

    def measure(self, values: Mapping[str, float], speed: float) -> dict[str, float]:
        """The results of the cycle, as `measure_cycle` gives them. Newton's method with the slopes of the
        scenario's own cycle looks for it, which takes few periods; where it finds no steady one, `find`."""
        cycle = self._find_near(self.change(values, speed), speed)
        if cycle is None or not cycle.steady:
            cycle = self.find(values, speed)
        return measure_cycle(cycle, self.subject.flywheel)

    def _find_near(self, system: System, speed: float) -> Cycle | None:
        start, period = self._start(speed, SAMPLES), find_period(system, speed)
        with suppress(ModelError):
            if speed not in self._near:
                fast = replace(self._search, move=CompiledMarch(self._search.problem))
                own = self.change({}, speed)
                self._near[speed] = learn_slopes(fast, own, period, self._turning, start, NEAR_TOLERANCE)
            return find_cycle(
                system, period, self._turning, start, SAMPLES,
                tolerance=NEAR_TOLERANCE, steady=self._steady, search=self._near[speed],
            )  # fmt: skip
        return None

    def change(self, values: Mapping[str, float], speed: float) -> System:
        """The system with these values at this speed (rad/s)."""
        flywheel, instances = self.subject.flywheel, dict(self.system.instances)
        changed = {name: dict(instance.parameters) for name, instance in instances.items()}
        changed[flywheel] |= {"initial_speed": speed, "final_speed": speed}
        for place, value in values.items():
            name, _, parameter = place.partition(".")
            if name not in instances or parameter not in instances[name].component.parameters:
                raise MistakeError(
                    f"{place}: no such parameter; {one_of(self.system.parameters.names, place)}"
                )
            check_varied(place, flywheel)
            changed[name][parameter] = value
        instances = {name: replace(one, parameters=changed[name]) for name, one in instances.items()}
        return self.system.with_instances(instances)

    def begin(self, values: Mapping[str, float], speed: float, samples: int | None = None) -> Cycle:
        """The cycle with these values from where `SpeedSubject.find_cycle_at` begins it: of states that stay
        as they have grown, such as a lash adjuster's, those of a scenario that is run alone."""
        system = resolve_start(self.subject.scenario, self.change(values, speed))
        return self._find(system, speed, None, samples or SAMPLES)

    def _start(self, speed: float, samples: int) -> Vector:
        if (speed, samples) not in self._starts:
            self._starts[speed, samples] = self.begin({}, speed, samples).end
        return self._starts[speed, samples]

    def _find(self, system: System, speed: float, start: Vector | None, samples: int) -> Cycle:
        period = find_period(system, speed)
        return find_cycle(
            system, period, self._turning, start, samples,
            tolerance=self._tolerance, steady=self._steady, search=self._search,
        )  # fmt: skip
