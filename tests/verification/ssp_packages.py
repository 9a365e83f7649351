"""Scenarios as SSP packages, and packages of other tools."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

from orchestrator.command_line.fmu import built
from orchestrator.scenario_files import load, shipped
from orchestrator.ssp import export
from tests.ssp.schemas import assert_valid

from .table import Row

ROUND = "ssp/test_round_trip.py::"
FOREIGN = "ssp/test_foreign_packages.py::"
# Finding the start of many valves takes minutes.
LONG = ("valve-train-16v", "engine-16v")


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as folder:
        yield _round_trips(Path(folder))
    yield Row(
        "without loss",
        "whatever hypothesis changes in a scenario comes back to the last bit; so do foreign FMUs, byte by "
        "byte",
        (
            ROUND + "test_whatever_is_changed_comes_back_to_the_last_bit",
            ROUND + "test_fmus_from_elsewhere_go_and_come_back",
            ROUND + "test_the_same_scenario_is_the_same_file",
            ROUND + "test_a_value_changed_in_the_package_is_changed_in_the_scenario",
        ),
    )
    yield Row(
        "foreign SSPs with third-party FMUs (the Modelica Reference-FMUs' kind) run in our master",
        "packages written as other tools write them, with FMUs in C of FMI 2 and 3: nested systems, units "
        "and transformations, parameter sets and mappings, signal dictionaries; libcosim and ecos run ours",
        (
            FOREIGN + "test_a_package_runs_as_it_is",
            FOREIGN + "test_connections_pass_through_nested_systems",
            FOREIGN + "test_values_come_by_every_way",
            FOREIGN + "test_what_is_not_supported_is_refused_by_name",
            "ssp/test_other_tools.py::test_another_tool_comes_to_the_same",
        ),
        command="tribocosim run OTHER.ssp",
    )


def _round_trips(folder: Path) -> Row:
    names = [name for name in shipped() if name not in LONG]
    lost = []
    for name in names:
        scenario, path = load(name), folder / f"{name}.ssp"
        export(scenario, path, built)
        assert_valid(path)
        if load(path) != scenario:
            lost.append(name)
    return Row(
        "every scenario exports to an `.ssp` (SSD with units and connector kinds, SSV, SSM, FMUs inside, "
        "solver annotation) and imports from one, round trip without loss",
        f"{len(names)} of {len(shipped())} shipped scenarios made into packages, valid by the schemas, and "
        f"back: {len(lost)} differ (values are named as the FMUs' variables, so ours need no SSM; others' "
        f"are read); the others ({', '.join(LONG)}) are a long test",
        (ROUND + "test_every_shipped_scenario_comes_back",),
        command="tribocosim ssp export valve-train",
        short=f"differ: {', '.join(lost)}." if lost else "",
    )
