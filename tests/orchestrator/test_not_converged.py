"""A step whose implicit equations do not converge: discarded, nothing changed, and shortened by who can."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from orchestrator.engine.step import DISCARD
from orchestrator.engine.substeps import Substepped
from orchestrator.errors import DiscardedStepError
from orchestrator.masters import GaussSeidel, Iterated, Jacobi
from orchestrator.participants import in_process, open_fmu
from orchestrator.stepping import ControlledSteps, StepControl
from tests.fmus.pack_component import pack_component
from tests.models.fluid_layer import fluid_layer

from .alone import Alone
from .coupled import run_coupled
from .dragged import dragged
from .recorder import Recorder

SHEETS = 20
# Two Newton iterations converge over 0.2 ms, not over 1 ms as soon as the plate is fast.
STUBBORN = {"iterations": 2.0}
SHORT, LONG, STOP = 2e-4, 1e-3, 4e-3
REASON = "the implicit equations of the step did not converge"
REMEDY = r"reduce macro_step, use \[step_control\], or raise components\.layer\.retries"


@pytest.fixture(scope="module")
def layer_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return pack_component(fluid_layer, tmp_path_factory.mktemp("layer"), sheets=SHEETS)


@pytest.fixture(params=["in-process", "fmu"])
def layers(request: pytest.FixtureRequest, layer_file: Path) -> Iterator[tuple[Alone, Alone]]:
    """With a plate whose speed is given."""
    instance = dragged(SHEETS, **STUBBORN).instances["layer"]

    def build() -> Alone:
        inside = request.param == "in-process"
        unit = in_process("layer", instance) if inside else open_fmu("layer", layer_file, instance)
        return Alone(unit, "velocity", ["force", "wall_force", "impulse"], 0.0)

    made = build(), build()
    yield made
    for one in made:
        one.unit.close()


def test_a_step_that_does_not_converge_is_discarded_and_leaves_the_state_as_it_was(layers) -> None:
    """What follows has the bits of a participant that was never asked for it."""
    failing, sound = layers
    for layer in layers:
        layer.advance(0.0, SHORT, 0.1)
    with pytest.raises(
        DiscardedStepError, match=f"^layer: step from t = 0.0002 s by 0.1 s.*{REASON}; .*{REMEDY}"
    ):
        failing.advance(SHORT, 0.1, 1.0)
    for k in range(1, 5):
        assert failing.advance(k * SHORT, SHORT, 0.1) == sound.advance(k * SHORT, SHORT, 0.1)
    assert failing.saved() == sound.saved()


@pytest.mark.parametrize(
    ("master", "estimator"),
    [
        (Jacobi("quadratic"), "step_doubling"),
        (GaussSeidel("linear"), "step_doubling"),
        (Iterated("hermite", 1e-11), "predictor_corrector"),
    ],
    ids=repr,
)
def test_step_control_shortens_steps_that_do_not_converge(master, estimator: str) -> None:
    """To the result that a component without a limit gives, within what the tolerance allows."""
    control = StepControl(estimator, relative=1e-2, absolute=1e-2, maximum_step=LONG)

    def controlled(**parameters: float) -> Recorder:
        return run_coupled(dragged(SHEETS, **parameters), master, ControlledSteps(LONG, control), STOP)

    stubborn, willing = controlled(**STUBBORN), controlled()
    assert any(step.rejected and step.reason == DISCARD for step in stubborn.steps)
    assert not any(step.reason == DISCARD for step in willing.steps)
    assert stubborn["plate.position"][-1] == pytest.approx(willing["plate.position"][-1], abs=1e-2 * 1e-3)


def test_retries_halve_steps_that_do_not_converge_under_steps_of_one_length() -> None:
    system = dragged(SHEETS, **STUBBORN)
    layer = Substepped(in_process("layer", system.instances["layer"]), halvings=4)
    recorder = run_coupled(system, Iterated("hermite", 1e-11), LONG, STOP, layer=layer)
    assert recorder.ended == (True, "")


@pytest.mark.parametrize("master", [Jacobi("linear"), Iterated("hermite")], ids=repr)
def test_steps_of_one_length_end_with_what_to_do(master) -> None:
    with pytest.raises(DiscardedStepError, match=f"layer: step .*{REASON}; {REMEDY}"):
        run_coupled(dragged(SHEETS, **STUBBORN), master, LONG, STOP)
