"""Shipped scenarios are within their tolerances; camshafts and cylinders of one engine are independent."""

import json
import tomllib

import numpy as np
import pytest

from benchmarks.many_valves import ENGINE, FILE, FIRING_ORDER, build_content, build_engine, list_phases
from models.core.system import System
from orchestrator.masters import GaussSeidel
from orchestrator.scenario.files import list_shipped, load
from orchestrator.scenario.system import build_system

from .commands import called
from .coupled import run_coupled


def run_short(system, steps, names=None):
    """The records of so many steps of 2 us, of the system or of these instances alone."""
    if names:
        own = {name: i for name, i in system.instances.items() if name in names}
        kept = [c for c in system.connections if {c.source.instance, c.target.instance} <= names]
        system = System(own, [(str(c.source), str(c.target)) for c in kept])
    return run_coupled(system, GaussSeidel("quadratic"), 2e-6, 2e-6 * steps)


@pytest.mark.parametrize("kind", ["intake", "exhaust"])
def test_noses_come_in_firing_order_half_a_crank_turn_apart(kind):
    """A cam is at its nose (180 deg) when the crank has turned by 2 (180 - phase)."""
    crank = [2.0 * (180.0 - list_phases()[f"{kind}_{cylinder}a"]) % 720.0 for cylinder in FIRING_ORDER]
    np.testing.assert_allclose(np.diff(crank) % 720.0, 180.0)


@pytest.mark.long
def test_camshafts_move_as_they_do_alone_and_give_way_to_their_followers():
    """The crankshaft's speed is prescribed: the same bits as alone. Axes move away from followers."""
    system = build_system(load("valve-train-16v"))
    together = run_short(system, 100)
    for kind in ("intake", "exhaust"):
        alone = run_short(system, 100, {n for n in system.instances if kind in n or n == "flywheel"})
        for output in (f"contact_{kind}_3a.load", f"tappet_{kind}_3a.position", f"{kind}_shaft.axis_y[6]"):
            np.testing.assert_array_equal(together[output], alone[output])
            assert np.ptp(alone[output]) > 0.0
        loads = np.array([together[f"tappet_{kind}_{c}{s}.cam_force_y"] for c in (1, 2, 3, 4) for s in "ab"])
        moved = np.array([together[f"{kind}_shaft.axis_y[{i}]"] for i in range(1, 9)])
        assert (loads[:, 1:] < 0.0).all()
        assert (moved.min(axis=1) < 0.0).all()


def test_the_file_is_what_the_script_writes():
    """Start values to 1e-9 of themselves: they are the reference's, on this machine."""

    def flat(table, path=""):
        for key, value in table.items():
            yield from flat(value, f"{path}{key}.") if isinstance(value, dict) else [(path + key, value)]

    written, made = dict(flat(tomllib.loads(FILE.read_text("utf-8")))), dict(flat(build_content()))
    assert written.keys() == made.keys()
    for key, value in made.items():
        expected = pytest.approx(value, rel=1e-6, abs=1e-12) if isinstance(value, float) else value
        assert written[key] == expected


@pytest.mark.parametrize(
    "steps", [pytest.param(3, marks=pytest.mark.plain), pytest.param(100, marks=pytest.mark.long)]
)
def test_cylinders_turn_in_firing_order_and_as_they_do_alone(steps):
    """Throws follow one another by half a turn; the shaft's speed is prescribed: the same bits as alone."""
    whole = build_system(load("engine-16v"))
    assert len(whole.instances) == 1 + 2 + 3 * 16 + 2 * 4
    cylinders = {name for name in whole.instances if name.startswith(("flywheel", "gas_", "piston_"))}
    together = run_short(whole, steps, cylinders if steps < 100 else None)
    for behind, cylinder in enumerate(FIRING_ORDER):
        angle = together["flywheel.angle"] - np.pi * behind
        np.testing.assert_allclose(together[f"flywheel.throw_angle[{cylinder}]"], angle, atol=1e-12)
    alone = run_short(whole, steps, {"flywheel", "gas_3", "piston_3"})
    for output in ("gas_3.gas_pressure", "piston_3.piston_offset"):
        np.testing.assert_array_equal(together[output], alone[output])
        assert np.ptp(alone[output]) > 0.0


def test_the_engine_file_is_what_the_script_writes():
    assert tomllib.loads(ENGINE.read_text("utf-8")) == build_engine()


# Those with solved films or sixteen valves and pistons take many minutes.
LENGTHY = {"engine-ehl", "valve-train-ehl", "valve-train-ehl-sweep", "engine-16v"}


@pytest.mark.long
@pytest.mark.parametrize("name", sorted(set(list_shipped()) - LENGTHY))
def test_a_run_is_within_its_tolerance_of_the_reference(name, tmp_path, record):
    done = called("run", name, "--no-figures", "--out", str(tmp_path / name))
    assert done.returncode == 0, done.stderr
    summary = json.loads((tmp_path / name / "summary.json").read_text("utf-8"))
    for variable, allowed in summary["tolerance"].items():
        quantity = f"scenario {name}: relative RMS error of {variable}"
        error = summary["errors"][variable]["relative_rms"]
        record("Coupling", quantity, error, 0.0, "monolithic solution", tolerance=allowed)
