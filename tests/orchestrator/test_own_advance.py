"""A component of a thousand states that its own implicit steps move, in every part of the orchestrator."""

from pathlib import Path

import numpy as np
import pytest

from models.core.bonds import counting
from models.core.system import System
from models.monolithic import solve
from orchestrator.engine.energy import Ledger, add_counting, add_estimates
from orchestrator.engine.energy.estimate import Estimating, without_estimates
from orchestrator.masters import GaussSeidel, Iterated, Newton
from orchestrator.participants import Participant, in_process, open_fmu
from orchestrator.store.json_codec import from_text
from tests.fmus.pack_component import pack_component
from tests.models.fluid_layer import fluid_layer

from .coupled import run_coupled
from .dragged import dragged
from .recorder import Recorder
from .test_checkpoint import Kept

SHEETS = 1000
STEP, STOP = 1e-4, 4e-3
ITERATED = Iterated("hermite", 1e-11)


@pytest.fixture(scope="module")
def layer_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return pack_component(fluid_layer, tmp_path_factory.mktemp("layer"), sheets=SHEETS)


def open_layer(system: System, path: Path) -> Participant:
    return open_fmu("layer", path, system.instances["layer"])


def test_a_coupled_run_comes_to_the_monolithic_one_with_the_order_of_the_components_steps() -> None:
    """Two, of the midpoint rule: the reference integrates the same sheets by their derivative."""
    system = dragged(sheets=5)
    times = np.linspace(0.0, STOP, 3)
    exact = solve(system, times)["layer.force"][-1]
    coarse, fine = (
        abs(run_coupled(system, ITERATED, step, STOP)["layer.force"][-1] - exact) for step in (2e-4, 1e-4)
    )
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.1)


@pytest.mark.long
@pytest.mark.parametrize("master", [GaussSeidel("linear"), ITERATED, Newton("linear")], ids=repr)
def test_an_fmu_of_a_thousand_states_runs_as_the_component_to_the_last_bit(master, layer_file: Path) -> None:
    """Also where it is rolled back many times in every macro step."""
    system = dragged(SHEETS)
    own = run_coupled(system, master, STEP, STOP)
    packed = run_coupled(system, master, STEP, STOP, layer=open_layer(system, layer_file))
    np.testing.assert_array_equal(packed.rows, own.rows)


@pytest.mark.long
@pytest.mark.parametrize("kind", [pytest.param("in-process", marks=pytest.mark.long), "fmu"])
def test_a_run_of_a_thousand_states_goes_on_from_a_checkpoint_to_the_last_bit(
    kind: str, layer_file: Path
) -> None:
    system, kept, rest = dragged(SHEETS), Kept(), Recorder()
    own = [{"layer": open_layer(system, layer_file)} if kind == "fmu" else {} for _ in range(2)]
    run_coupled(system, ITERATED, STEP, STOP, recorder=kept, **own[0])
    middle = len(kept.states) // 2
    resumed = from_text(kept.states[middle])
    run_coupled(system, ITERATED, STEP, STOP, recorder=rest, resumed=resumed, **own[1])
    np.testing.assert_array_equal(rest.rows, kept.rows[middle + 1 :])


@pytest.mark.long
def test_energies_that_a_component_counts_in_its_own_steps_close_to_rounding() -> None:
    """The midpoint rule has the balance of a quadratic energy exactly, with powers taken at the middle."""
    system = add_counting(dragged(SHEETS), ["layer", "plate"])
    ledger = Ledger(system)
    run_coupled(system, ITERATED, STEP, STOP, ledger)
    layer = ledger.account().components["layer"]
    assert layer.dissipated > 1e-4
    # 40 steps of sums over 1000 sheets, to Newton's 1e-12 of velocities of 0.1 m/s.
    assert abs(layer.unaccounted) < 40 * 1e-11 * layer.dissipated


@pytest.mark.long
def test_a_component_of_unknown_equations_does_not_count_and_is_estimated() -> None:
    """Of what its plate and it exchange, to the order of the exchange."""
    plain = dragged(changes={"opaque": True})
    with pytest.raises(ValueError, match="fluid_layer"):
        counting(plain.instances["layer"].component)
    system = add_estimates(add_counting(plain, ["plate"]))
    ledger = Ledger(system)
    inner = in_process("layer", without_estimates(system.instances["layer"]))
    layer = Estimating(inner, system.instances["layer"].component)
    run_coupled(system, ITERATED, 2e-5, STOP, ledger, layer=layer)
    counting_both = add_counting(dragged(), ["plate", "layer"])
    own = Ledger(counting_both)
    run_coupled(counting_both, ITERATED, 2e-5, STOP, own)
    bond = "taken layer.force * plate.velocity"
    assert ledger[bond] == pytest.approx(own[bond], rel=1e-3)
