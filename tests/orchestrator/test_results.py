"""The result file: what is written is read, survives the process, and costs no memory."""

import csv
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest

from models.quantities import Quantity
from orchestrator.recording import CsvRecorder, ResultRecorder
from orchestrator.results import BLOCK, ResultFile, open_result

QUANTITIES = {
    "contact.load": Quantity("N", "contact load W", display_unit="kN"),
    "spring.coil_position[1]": Quantity("m", "coil displacement"),
}


def _recorded(path: Path, steps: int, every: int) -> None:
    file = ResultFile(path, {"scenario": "test"})
    recorder = ResultRecorder(file, QUANTITIES, every)
    recorder.begin(list(QUANTITIES))
    values = np.zeros(2)
    for i in range(steps + 1):
        values[:] = i, -i
        recorder.observe(1e-6 * i, values.copy, min(i, 1))
    recorder.end(True, "")
    file.finish(True, "")
    file.close()


@pytest.mark.parametrize("every", [1, 3])
def test_round_trip_through_xarray(tmp_path: Path, every: int) -> None:
    steps = 2 * BLOCK + 5
    _recorded(tmp_path / "result.nc", steps, every)
    tree = open_result(tmp_path)
    coupled = tree["coupled"]
    expected = np.arange(0.0, steps + 1.0, every)
    assert np.array_equal(coupled["contact.load"], expected)
    assert np.array_equal(coupled["spring.coil_position[1]"], -expected)
    assert np.array_equal(coupled["time"], 1e-6 * expected)
    assert coupled["contact.load"].attrs["units"] == "N"
    assert coupled["contact.load"].attrs["long_name"] == "contact load W"
    assert tree["steps"].sizes["time"] == steps
    assert np.all(tree["steps"]["iterations"] == 1)
    assert (tree.attrs["complete"], tree.attrs["scenario"]) == (1, "test")
    tree.close()


def test_csv_is_in_cross_check_layout_and_exact(tmp_path: Path) -> None:
    recorder = CsvRecorder(tmp_path / "out.csv", every=2)
    recorder.begin(list(QUANTITIES))
    values = np.array([1.0 / 3.0, 1e-300])
    for i in range(5):
        recorder.observe(0.1 * i, values.copy, 1)
    recorder.end(True, "")
    with (tmp_path / "out.csv").open() as file:
        first = file.readline().strip()
        rows = [[float(text) for text in row] for row in csv.reader(file)]
    assert first == '"time","contact.load","spring.coil_position[1]"'
    assert rows == [[0.1 * i, *values] for i in (0, 2, 4)]


def _in_a_process(code: str) -> subprocess.CompletedProcess[str]:
    root = Path(__file__).parents[2]
    script = textwrap.dedent(code)
    return subprocess.run(
        [sys.executable, "-c", script], cwd=root, capture_output=True, text=True, timeout=100
    )


def test_what_was_flushed_survives_a_killed_process(tmp_path: Path) -> None:
    path = tmp_path / "result.nc"
    done = _in_a_process(f"""
        import os
        import numpy as np
        from pathlib import Path
        from orchestrator.recording import ResultRecorder
        from orchestrator.results import BLOCK, ResultFile
        from tests.orchestrator.test_results import QUANTITIES
        recorder = ResultRecorder(ResultFile(Path({str(path)!r}), {{}}), QUANTITIES, 1)
        recorder.begin(list(QUANTITIES))
        for i in range(BLOCK + 7):
            recorder.observe(1e-6 * i, np.array([i, 0.0]).copy, 1)
        os._exit(9)
    """)
    assert done.returncode == 9
    tree = open_result(path)
    assert tree.attrs["complete"] == 0
    assert "not finished" in tree.attrs["message"]
    assert np.array_equal(tree["coupled"]["contact.load"][:BLOCK], np.arange(BLOCK))
    tree.close()


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="reads Linux's memory figures")
@pytest.mark.parametrize("steps", [100_000, pytest.param(1_000_000, marks=pytest.mark.long)])
def test_memory_does_not_grow_with_the_steps(tmp_path: Path, steps: int) -> None:
    """A million macro steps of 45 outputs would be 368 MB of doubles; the bound is 500 MB in all."""
    done = _in_a_process(f"""
        import numpy as np
        from pathlib import Path
        from models.quantities import Quantity
        from orchestrator.recording import ResultRecorder
        from orchestrator.results import ResultFile
        names = [f"a.v{{i}}" for i in range(45)]
        file = ResultFile(Path({str(tmp_path / "result.nc")!r}), {{}})
        recorder = ResultRecorder(file, {{name: Quantity("m", "x") for name in names}}, 1)
        recorder.begin(names)
        values = np.random.default_rng(1).random(45)
        def peak():
            # Not getrusage: its peak comes along from the process that started this one.
            status = Path("/proc/self/status").read_text()
            return int(status.split("VmHWM:")[1].split()[0]) / 1024.0
        for i in range({steps}):
            recorder.observe(1e-6 * i, values.copy, 1)
            if i == 20_000:
                before = peak()
        recorder.end(True, "")
        file.close()
        print(peak() - before, peak())
    """)
    growth, peak = map(float, done.stdout.split())
    # Index nodes of the file, of which HDF5 keeps some; the data would be 36 MB per 100 000 steps.
    assert growth < 20.0
    assert peak < 500.0
