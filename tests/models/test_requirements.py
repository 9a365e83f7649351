"""A requirement's message has the numbers and the word that its kernel left."""

from dataclasses import replace
from typing import Any

import pytest

from models.catalogue import CATALOGUE
from models.core.bonds import counting
from models.core.requirements import Requirement


def broken(a: float, told: Any) -> bool:
    told[0], told[1] = a, 1.0 / 3.0
    return a < 0.0


def test_numbers_stand_in_their_places() -> None:
    rule = Requirement(broken, "a = {0:g} m: must be {1:.3f} or {1:.9g}, not {0:g}")
    assert rule.fault(-1.0) is None
    assert rule.fault(2.5e-7) == "a = 2.5e-07 m: must be 0.333 or 0.333333333, not 2.5e-07"


def test_the_first_number_counts_the_word() -> None:
    rule = Requirement(broken, "a: not on the {word} wall", words=("lower", "upper"))
    assert rule.fault(0.0) == "a: not on the lower wall"
    assert rule.fault(1.0) == "a: not on the upper wall"


@pytest.mark.parametrize("text", ["{0}", "{8:g}", "{0:d}", "{name}", "50 %}"])
def test_braces_that_machine_code_cannot_fill_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match="is no place"):
        Requirement(broken, f"a = {text}")


def test_messages_on_starts_begin_with_a_state() -> None:
    """So that FMUs can name the variable of its start."""
    for component in (make() for make in CATALOGUE.values()):
        states = {state.partition("[")[0] for state in component.state.names}
        assert all(rule.says.partition(" ")[0].rstrip(":") in states for rule in component.start_requirements)


def test_counting_energies_does_not_change_the_records_that_rules_see() -> None:
    """For a longer record numba would compile each rule again, and warn that it is taken for the shorter."""
    seen = []
    rule = Requirement(lambda x, u, p, told: seen.append(x.dtype) or True, "height = {0:g}")
    plain = replace(CATALOGUE["falling_mass"](), start_requirements=[rule])
    for component in (plain, counting(plain)):
        start = component.state.vector()
        assert component.start_faults(component.parameters.vector(), start, component.inputs.vector()) == []
    assert seen == [plain.state.dtype] * 2
