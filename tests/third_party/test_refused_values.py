"""Values that do not fit a third-party FMU are refused by name, when the scenario is read."""

from pathlib import Path

import pytest

from orchestrator.scenario import ScenarioError

from .c_fmus import fmu
from .runs import scenario

KNOWN = r"must be one of steel, brass, other, or their numbers \(1, 2, 9\)"
# The FMU, the table and its values, and what is said.
REFUSED = [
    ("dahlquist", "parameters", {"K": 1.0}, r"\.K: no such parameter"),
    ("dahlquist", "parameters", {"k": "8 mm"}, "states no unit; write a plain number"),
    ("dahlquist", "structure", {"n": 3}, "structure.n: .*leave it out"),
    ("reading", "parameters", {"table file": 8.0}, r"file = 8\.0 \(String\): must be a string"),
    ("reading", "parameters", {"table file": "a\0b"}, "without null characters"),
    ("reading", "parameters", {"raw": "0ff"}, r"raw = .0ff. \(Binary\): must be pairs of hexadecimal digits"),
    ("reading", "parameters", {"scale": "much"}, "scale.*much"),
    ("sized", "structure", {"m": 3}, "structure.m: no such structural parameter; .*n"),
    ("sized", "structure", {"n": 5}, r"structure.n = 5 \(n\): must be at least 1 and at most 4"),
    ("sized", "structure", {"n": 3}, "parameters.x0: has 3 elements .* give all of them"),
    ("sized", "parameters", {"x0": [1.0]}, r"parameters.x0 = \[1.0\]: must have 2 values"),
    ("sized", "parameters", {"x0": [[1.0], [2.0]]}, "parameters.x0 = .*: must have 2 values"),
    ("sized", "parameters", {"n": 3}, "parameters.n: no such parameter; it belongs in structure"),
    (
        "stretched",
        "parameters",
        {"material": "stel"},
        rf"'stel' \(material\): did you mean steel\? It {KNOWN}",
    ),
    ("stretched", "parameters", {"material": 1.5}, rf"material = 1\.5 \(material\): {KNOWN}"),
    ("stretched", "parameters", {"material": True}, rf"material = True \(material\): {KNOWN}"),
    ("stretched", "start", {"material": 2}, "material: no such state; it belongs in parameters"),
    ("stretched", "inputs", {"length": 2}, "length: no such input; it belongs in start"),
    ("stretched", "inputs", {"force": 2}, "force: no such input; leave it out$"),
]


@pytest.mark.parametrize(("name", "table", "values", "said"), REFUSED)
def test_a_value_that_does_not_fit_is_named(
    name: str, table: str, values: dict[str, object], said: str, tmp_path: Path
) -> None:
    with pytest.raises(ScenarioError, match=said):
        scenario({"one": {"participant": fmu(name, 3, tmp_path), table: values}})
