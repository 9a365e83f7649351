"""A host of model exchange: the monolithic reference's CVODE over an FMU, with inputs and location of events.

fmpy's own host holds inputs while its solver steps, which is good for FMUs without any.
"""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from fmpy.model_description import ModelDescription
from fmpy.simulation import Recorder, instantiate_fmu
from numpy.typing import NDArray

from models.core.quantities import Vector
from models.monolithic.cvode import Cvode
from models.monolithic.march import march
from models.monolithic.problem import Event
from models.monolithic.reference import stiffness

from ..fmi.model_exchange import EventError, ModelExchange
from .files import ComparisonError, Options, Table

# Whole numbers among inputs are set at corners only, as events.
_CONTINUOUS = ("Real", "Float64", "Float32")
_INTEGERS = {"Enumeration": {"2.0": "Integer", "3": "Int64"}}
# An instant so near to another (s, over the time) is the same.
_SAME = 1e-12


def integrate(
    path: Path,
    described: ModelDescription,
    options: Options,
    inputs: Table | None,
    instants: Vector,
    names: list[str],
    tolerance: float,
) -> NDArray[np.void]:
    """Variables `names` of the FMU at `instants`, as fmpy records them, integrated to `tolerance`."""
    folder = fmpy.extract(str(path))
    try:
        fmu = instantiate_fmu(folder, described, "ModelExchange")
        try:
            return run(Hosted(fmu, described, inputs), described, options, instants, names, tolerance)
        except EventError as error:
            raise ComparisonError(str(error)) from None
        finally:
            fmu.freeInstance()
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def run(
    problem: Hosted,
    described: ModelDescription,
    options: Options,
    instants: Vector,
    names: list[str],
    tolerance: float,
) -> NDArray[np.void]:
    """As `integrated`, of an instance that is not yet initialised."""
    recorder = Recorder(problem.fmu, described, names)
    t, stop = options.start_time, options.stop_time
    problem.initialise(t, stop)
    z = problem.state()
    recorder.sample(t)
    stiff, longest = stiffness(problem, t, z, np.union1d([t, stop], instants))
    corners = problem.corners[(problem.corners > t) & (problem.corners < stop)]
    targets = np.union1d(corners, instants[(instants > t) & (instants <= stop)])
    for target in targets.tolist():
        if target - t > _SAME * abs(stop):
            states, _ = march(problem, Cvode(problem, tolerance, stiff, longest), z, t, np.array([target]))
            t, z = target, states[-1]
            problem.complete_step(t, z)
            z = problem.state()
        recorder.sample(t)
        if target in corners:
            problem.corner(t)
            z = problem.state()
            recorder.sample(t)
    return np.asarray(recorder.result())


class Hosted:
    """An FMU as a problem for the reference's solvers.

    What a transition does is the FMU's event mode.
    """

    def __init__(self, fmu: Any, described: ModelDescription, inputs: Table | None) -> None:
        self.fmu = fmu
        self._second = described.fmiVersion == "2.0"
        self.size = int(described.numberOfContinuousStates)
        indicators = int(described.numberOfEventIndicators)
        self._exchange = ModelExchange(fmu, self._second, self.size, indicators)
        self.guard_count = indicators
        self.nominal = np.ones(max(self.size, 1))
        self.whole = np.zeros(self.nominal.size, dtype=bool)
        self._rate = np.zeros(self.nominal.size)
        self._table = inputs
        self.corners = np.zeros(0) if inputs is None else np.unique(inputs.times)
        self._row = 0
        self._groups = _groups(described, inputs)

    def initialise(self, start: float, stop: float) -> None:
        """Ready to integrate from `start`."""
        if self._second:
            self.fmu.setupExperiment(startTime=start, stopTime=stop)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=start, stopTime=stop)
        self._enter(start)
        self._set_inputs(start, discrete=True)
        self.fmu.exitInitializationMode()
        self._exchange.settle()
        self.nominal[: self.size] = self._exchange.nominal()

    def state(self) -> Vector:
        """The continuous states as they are."""
        return self._exchange.states() if self.size else np.zeros(1)

    def rate(self, t: float, z: Vector) -> Vector:
        self._at(t, z)
        self._rate[: self.size] = self._exchange.rate()
        return self._rate

    def guards(self, t: float, z: Vector) -> Vector:
        self._at(t, z)
        return self._exchange.guards()

    @property
    def next_event(self) -> float:
        """Of the FMU's time events."""
        return self._exchange.next_event

    def transition(self, guard: int, t: float, z: Vector) -> Event:
        self._at(t, z)
        self._exchange.enter_events()
        self._exchange.settle()
        z[:] = self.state()
        return Event(t, "", guard)

    def complete_step(self, t: float, z: Vector) -> None:
        """The solver has come to (t, z); the FMU may ask for an event."""
        self._at(t, z)
        if self._exchange.complete_step():
            self.transition(0, t, z)

    def corner(self, t: float) -> None:
        """From here on inputs are those of the next piece: an event."""
        self._exchange.enter_events()
        self._enter(t)
        self._set_inputs(t, discrete=True)
        self._exchange.settle()

    def _at(self, t: float, z: Vector) -> None:
        self._exchange.move(t, z[: self.size])
        self._set_inputs(t, discrete=False)

    def _enter(self, t: float) -> None:
        """The piece of the inputs that begins at t, or in which t lies."""
        if self._table is not None:
            later = np.flatnonzero(self._table.times > t)
            self._row = int(later[0]) - 1 if later.size else self._table.times.size - 1
            self._row = max(self._row, 0)

    def _set_inputs(self, t: float, discrete: bool) -> None:
        if self._table is None:
            return
        times, i = self._table.times, self._row
        j = min(i + 1, times.size - 1)
        share = (min(max(t, times[i]), times[j]) - times[i]) / (times[j] - times[i]) if j > i else 0.0
        for kind, (names, references) in self._groups.items():
            columns = [self._table.columns[name] for name in names]
            if kind in _CONTINUOUS:
                values = [float(c[i] + share * (c[j] - c[i])) for c in columns]
            elif discrete:
                values = [int(c[i]) for c in columns]
            else:
                continue
            getattr(self.fmu, f"set{kind}")(references, values)


def _groups(described: ModelDescription, inputs: Table | None) -> Mapping[str, tuple[list[str], list[int]]]:
    """Names and references of the inputs by the type whose function sets them."""
    version = "2.0" if described.fmiVersion == "2.0" else "3"
    groups: dict[str, tuple[list[str], list[int]]] = {}
    for variable in described.modelVariables:
        if inputs is not None and variable.name in inputs.columns:
            kind = _INTEGERS.get(variable.type, {}).get(version, variable.type)
            names, references = groups.setdefault(kind, ([], []))
            names.append(variable.name)
            references.append(variable.valueReference)
    return groups
