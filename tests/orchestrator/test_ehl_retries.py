"""A contact with a solved film under `retries`: a step that it discards is cut, and its state is unharmed."""

from __future__ import annotations

import pytest

from models.contact.ehl_line_contact import ehl_line_contact
from models.core.system import Instance
from orchestrator.engine.substeps import Substepped
from orchestrator.errors import DiscardedStepError
from orchestrator.participants import in_process

from .alone import Alone

STEP, RADIUS = 1e-5, 0.01


def contact(halvings: int) -> Alone:
    """Of a radius that is given."""
    instance = Instance(ehl_line_contact(nodes=101), inputs={"approach": 2e-6, "entraining_velocity": 1.0})
    unit = in_process("contact", instance)
    if halvings:
        unit = Substepped(unit, halvings=halvings)
    outputs = ["load", "minimum_film_thickness"]
    return Alone(unit, "radius_of_curvature", outputs, RADIUS)


@pytest.mark.long
def test_a_step_that_no_cut_can_save_is_made_as_far_as_it_goes_and_leaves_no_trace() -> None:
    """The radius falls through zero at a third of the step: its first quarter is made, and told. When the
    master took it back, what follows has the bits of a contact that was never asked, with retries or not."""
    asked, spared, plain = contact(2), contact(2), contact(0)
    for one in (asked, spared, plain):
        for k in range(3):
            one.advance(k * STEP, STEP, RADIUS)
    before = asked.unit.save()
    with pytest.raises(DiscardedStepError, match=r"radius_of_curvature = -.* must be > 0") as caught:
        asked.advance(3.0 * STEP, STEP, RADIUS, -3.0 * RADIUS / STEP)
    assert caught.value.reached == pytest.approx(3.25 * STEP, rel=1e-12)
    asked.unit.restore(before)
    asked.unit.release(before)
    for k in range(3, 6):
        found = asked.advance(k * STEP, STEP, RADIUS)
        assert found == spared.advance(k * STEP, STEP, RADIUS)
        assert found == plain.advance(k * STEP, STEP, RADIUS)
    assert asked.saved() == spared.saved()
    for one in (asked, spared, plain):
        one.unit.close()
