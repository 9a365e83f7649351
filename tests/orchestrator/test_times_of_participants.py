"""What a run's time went into, by participant."""

import math

import numpy as np
import pytest

from orchestrator.assessment.diagnosis.times import list_parts, read_spending
from orchestrator.engine.effort import Sampled

from ..third_party.c_fmus import fmu
from ..third_party.runs import ran, scenario
from .commands import called


def test_the_slow_fmu_is_named_with_its_time(tmp_path):
    """Of steps that take 2 ms at least, made by compiled code, which times few of them."""
    tables = {
        name: {"participant": fmu(name, 2, tmp_path), "process": "shared"} for name in ("dahlquist", "slow")
    }
    out, steps = tmp_path / "out", 1000
    ran(scenario(tables, master={"name": "jacobi"}, macro_step=0.5), tmp_path / "compiled")
    summary, _ = ran(scenario(tables, master={"name": "jacobi"}, macro_step=1.0 / steps), out)
    slow, quick = summary.effort["slow"], summary.effort["dahlquist"]
    assert slow.do_steps == quick.do_steps == steps
    # The steps after the last that is timed are left out: one of 127 at most, of 1000.
    assert slow.stepping_s > 0.85 * 2e-3 * steps
    assert quick.stepping_s < 0.5 * slow.stepping_s
    lines = called("diagnose", str(out)).stdout.splitlines()
    head = next(i for i, line in enumerate(lines) if line.startswith("participant"))
    assert [line.split()[0] for line in lines[head + 1 : head + 3]] == ["slow", "dahlquist"]
    assert "into steps of slow" in lines[0]


def test_a_timed_call_that_waits_for_the_processor_counts_once():
    """Calls that differ by chance have their sum: its error is that of 400 samples of 1/sqrt(12), twice."""
    times = np.random.default_rng(1).uniform(0.5, 1.5, (400, 127))
    quiet, disturbed = Sampled(), Sampled()
    found = sum(quiet.count(row[-1], 127) for row in times)
    assert found == pytest.approx(times.sum(), rel=3.0 * 2.0 / math.sqrt(12.0 * 400))
    waiting = [100.0 if k % 50 == 49 else 0.0 for k in range(400)]
    more = sum(disturbed.count(row[-1] + wait, 127) for row, wait in zip(times, waiting, strict=True))
    # A median of three with the largest one in it is that of the other two's larger.
    assert 0.0 < more - found - sum(waiting) < 3 * 8 * 126 * 1.0


def test_what_a_participant_does_within_macro_steps_is_counted(tmp_path):
    """The parts of the time add up to the whole."""
    tables = {"dahlquist": {"participant": fmu("dahlquist", 2, tmp_path), "substeps": 3}}
    one = scenario(tables, master={"name": "jacobi"}, macro_step=0.1)
    ran(one, tmp_path / "out")
    spending = read_spending(tmp_path / "out" / "summary.json")
    assert (spending.effort["dahlquist"].own_steps, spending.effort["dahlquist"].failed) == (30, 0)
    assert sum(part.seconds for part in list_parts(one, spending)) == pytest.approx(spending.wall_s, rel=1e-9)
