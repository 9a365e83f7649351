"""Which participants are linearised how: components by their equations where they have any, FMU files by
their directional derivatives where they give them, others by their responses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path

from models.core.system import System

from ..participants import FmuParticipant, Participant, in_process, open_fmu
from ..run.assembly import Builder, check_analysable
from ..scenario import Scenario, ScenarioError
from .directional import Directional
from .linearisation import Equations, Linearisation
from .responses import Responses
from .trajectory import Along, fed, shown


@contextmanager
def linearisations(
    scenario: Scenario, system: System, build: Builder | None, every: bool = False
) -> Iterator[dict[str, Linearisation]]:
    """Of every instance: FMU files by their directional derivatives or else their responses, as components
    that are no ODE, others by their equations.

    `every`: all as they would take part in a run, by their responses. Participants live as long as the
    block. ScenarioError for one that cannot save its state, or that has a field, and for what
    `check_analysable` refuses.
    """
    check_analysable(scenario)
    with ExitStack() as stack:
        made: dict[str, Linearisation] = {}
        for name, table in scenario.components.items():
            component = system.instances[name].component
            ode = component.ode
            if not ode and component.implicit:
                # Measured on valve-train-ehl at 4 us: residuals of 54 to 878 %, and limits far too low.
                raise ScenarioError(
                    f"components.{name}: its field moves by steps whose errors ({table.component}'s "
                    "field_tolerance) hide the answers to small changes, so that its coupling cannot be "
                    f"analysed; take a formula in its place, --set components.{name}.structure.nodes=0 "
                    f"--set components.{name}.parameters.film_model=dowson_higginson"
                )
            if ode and not (every or table.participant.endswith(".fmu")):
                made[name] = Equations(system, name)
                continue
            unit = _participant(scenario, system, name, build)
            stack.callback(unit.close)
            exchanged = [*fed(name, system), *shown(name, system)]
            if not every and isinstance(unit, FmuParticipant) and unit.linearisable(exchanged):
                made[name] = Directional(name, unit, system)
                continue
            if not unit.restorable:
                raise ScenarioError(
                    f"components.{name}.participant: {table.participant} cannot save and restore its state "
                    "(canGetAndSetFMUstate = false), by which it is linearised; take an FMU that can, or set "
                    f"components.{name}.participant='in-process' to analyse the component in its place"
                )
            made[name] = Responses(name, unit, system, scenario.macro_step)
        yield made


def _participant(scenario: Scenario, system: System, name: str, build: Builder | None) -> Participant:
    table, instance = scenario.components[name], system.instances[name]
    if table.participant.endswith(".fmu"):
        return open_fmu(name, Path(table.participant), instance)
    if table.participant == "in-process" or build is None:
        return in_process(name, instance)
    return open_fmu(name, build(table.component, table.structure, table.participant), instance)


def as_participants(made: Mapping[str, Linearisation]) -> dict[str, Along]:
    """Those that are participants."""
    return {name: source for name, source in made.items() if isinstance(source, Along)}
