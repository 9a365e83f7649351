"""The cycles of trains of a tolerance study, as the subject of a study."""

import functools
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from models.core import roles
from models.core.system import ModelError
from models.valve_train.worn_cam import sample_cam

from ...analyses import Parameter, Result
from ...errors import IncompleteError, MistakeError, one_of
from ...scenario import Scenario, build_scenario
from ...scenario.cams import read_cam
from ...scenario.system import list_parameters, list_quantities
from ...scenario.units import UnitError, to_unit
from ...scenario.values import Value
from ...texts import parse_toml
from ..speeds.finder import CycleFinder
from ..speeds.subject import SpeedSubject, check_varied, find_flywheel
from ..subjects import NumberedSubject
from .design import Design, Factor, GrindingError, Parameters
from .distributions import group, resolve
from .table import Tolerances, parse_tolerances

TRAIN = Parameter(0.0, "1", "number of the train: the first has the mean values")
# Points of a wave that a cam's table needs: 720 on a turn.
HIGHEST_ORDER = 90


@dataclass(frozen=True)
class ToleranceSubject(NumberedSubject):
    """The trains of a tolerance file: the scenario as it is given and as it runs, with points for the cams
    that have grinding errors, its flywheel, the speed (rad/s), and the file's tables as JSON."""

    axis = TRAIN

    given: str
    running: str
    flywheel: str
    speed: float
    tables: str

    @property
    def design(self) -> Design:
        return _open(self).design

    @property
    def results(self) -> Mapping[str, Result]:
        return _open(self).results

    def content(self) -> str:
        """Without the limits: trains are judged by other ones without being computed again."""
        tables = {**json.loads(self.tables), "limits": []}
        return json.dumps({"speed": self.speed, "tolerances": tables}) + self.running

    def evaluate(self, values: Mapping[str, Value]) -> Mapping[str, float | str]:
        design, finder, _ = _open(self)
        drawn = design.values[round(float(values["train"]))]
        varied = dict(zip(design.names, map(float, drawn), strict=True))
        try:
            return {**varied, **finder.measure(design.settings(drawn), self.speed)}
        except ModelError as error:
            raise IncompleteError(str(error), varied) from None


class _Opened(NamedTuple):
    design: Design
    finder: CycleFinder
    results: Mapping[str, Result]


@functools.lru_cache(maxsize=2)
def _open(subject: ToleranceSubject) -> _Opened:
    """Once in each process."""
    tolerances = parse_tolerances(json.loads(subject.tables))
    design = make_design(tolerances, build_scenario(parse_toml(subject.given)))
    finder = CycleFinder(SpeedSubject(parse_toml(subject.running), subject.flywheel))
    quantities = list_quantities(finder.subject.scenario)
    varied = {
        name: Result(quantities[name].unit, quantities[name].description)
        if name in quantities
        else Result("m", "part of a wave of the lift")
        for name in design.names
    }
    return _Opened(design, finder, varied | dict(finder.subject.results))


def make_design(tolerances: Tolerances, scenario: Scenario) -> Design:
    """MistakeError for what the scenario cannot vary."""
    values, quantities = list_parameters(scenario), list_quantities(scenario)
    for name in tolerances.parameters:
        if name not in values:
            raise MistakeError(f"parameters.{name}: no such parameter; {one_of(values, name)}")
        check_varied(name, find_flywheel(scenario))
    distributions = {
        name: resolve(name, given, quantities[name], values[name])
        for name, given in tolerances.parameters.items()
    }
    factors: dict[str, Factor] = {
        " with ".join(names): Parameters(names, tuple(distributions[name] for name in names), root)
        for names, root in group(list(distributions), tolerances.correlations)
    }
    for cam in tolerances.grinding:
        factors[f"{cam} grinding"] = _make_grinding(tolerances, scenario, cam)
    return Design(factors, tolerances.count // 2, tolerances.indices, tolerances.seed)


def _make_grinding(tolerances: Tolerances, scenario: Scenario, cam: str) -> GrindingError:
    table = scenario.components.get(cam)
    if table is None:
        raise MistakeError(f"grinding.{cam}: no such component; {one_of(scenario.components, cam)}")
    if not table.resolve().has_role(roles.Cam):
        cams = [name for name, one in scenario.components.items() if one.resolve().has_role(roles.Cam)]
        raise MistakeError(f"grinding.{cam}: is no cam; {one_of(cams, cam)}")
    fresh = sample_cam(read_cam(table))
    given = tolerances.grinding[cam].amplitudes
    amplitudes = []
    for order, text in given.items():
        place = f"grinding.{cam}.amplitudes.{order}"
        if not 1 <= order <= HIGHEST_ORDER:
            raise MistakeError(f"{place}: must be from 1 to {HIGHEST_ORDER} waves on a turn")
        try:
            amplitudes.append(to_unit(str(text), "m"))
        except UnitError as error:
            raise MistakeError(f"{place}: {error}") from None
        if not amplitudes[-1] > 0.0:
            raise MistakeError(f"{place} = {text}: must be > 0")
    return GrindingError(cam, tuple(given), tuple(amplitudes), fresh)
