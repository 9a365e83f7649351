"""Check that the equations of a scenario are known."""

from __future__ import annotations

from ...participants.transformed import Linear
from ...scenario import Scenario, ScenarioError
from ...scenario.conversion import find_transformations
from ...scenario.system import build_instances


def check_analysable(scenario: Scenario) -> None:
    """Raise ScenarioError for third-party FMUs and for connections that change values."""
    for name, table in scenario.components.items():
        if table.third_party:
            raise ScenarioError(
                f"components.{name}: a third-party FMU, whose equations are not known here, is not "
                "analysed; tribocosim run with several macro steps shows what they do"
            )
    for name, inputs in find_transformations(*build_instances(scenario)).items():
        for variable, linear in inputs.items():
            if linear != Linear():
                raise ScenarioError(
                    f"{name}.{variable}: its connection has a factor, an offset or converts units, which is "
                    "not known to the analysis; connect variables of one unit as they are"
                )
