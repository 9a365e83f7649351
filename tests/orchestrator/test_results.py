"""Results: what is recorded and written is read, survives the process, and costs no memory."""

import csv
import subprocess
import sys
import textwrap
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray
from rich.console import Console

from models.core.quantities import Quantity
from orchestrator.engine.step import Step
from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.run.record import ResultRecorder
from orchestrator.run.summary import OUTSIDE, Summary
from orchestrator.scenario.files import load
from orchestrator.stepping import FixedSteps
from orchestrator.store.coordinates import Coordinate
from orchestrator.store.csv_file import ROWS, write_csv, write_rows
from orchestrator.store.journal import HELD, Journal, JournalError, Mark, Recorded, journals
from orchestrator.store.result_file import CHUNK, ResultFile, open_result
from tribocosim.cached_fmus import build_fmu

from .commands import HERE

QUANTITIES = {
    "contact.load": Quantity("N", "contact load W", display_unit="kN"),
    "spring.coil_position[1]": Quantity("m", "coil displacement"),
}


def _record(folder: Path, quantities: dict[str, Quantity], rows: Iterable[Any], every: int = 1) -> None:
    """The journals of macro steps of 1 us with these outputs at their ends."""
    recorder = ResultRecorder(folder, quantities, every)
    recorder.begin(list(quantities))
    for i, row in enumerate(rows):
        recorder.observe(1e-6 * i, np.array(row, dtype=float).copy, Step(1e-6 * i, 1.0, 1))
    recorder.end(True, "")


def test_angles_are_coordinates_of_the_result_and_last_columns_in_degrees(tmp_path):
    """Twice the first column: a crank's angle of a cam's; a group without that column has no such angle."""
    quantity = Quantity("rad", "crank angle: 2 times cam.angle", display_unit="deg")
    angles = {"crank_angle": Coordinate("cam.angle", 2.0, quantity)}
    _record(tmp_path, {"cam.angle": Quantity("rad", "angle")}, [[0.5 * np.pi * i] for i in range(3)])
    found = {name: Recorded(path) for name, path in journals(tmp_path).items()}
    with ResultFile(tmp_path / "result.nc", {}, angles) as file:
        for name, recorded in found.items():
            file.take(name, recorded)
        assert list(file.quantities("coupled")) == ["cam.angle"]
        file.finish(True, "")
    with open_result(tmp_path) as tree:
        coupled = tree["coupled"].to_dataset()
        assert set(coupled.coords) == {"time", "crank_angle"}
        np.testing.assert_array_equal(coupled["crank_angle"], np.pi * np.arange(3))
        assert coupled["cam.angle"].coords["crank_angle"].attrs["display_units"] == "deg"
        assert set(tree["steps"].coords) == {"time"}
    write_csv(tmp_path / "out.csv", tmp_path / "units.csv", found["coupled"], angles)
    head, *rows = csv.reader((tmp_path / "out.csv").read_text().splitlines())
    assert head == ["time", "cam.angle", "crank_angle_deg"]
    assert [float(row[2]) for row in rows] == [0.0, 180.0, 360.0]
    assert '"crank_angle_deg","deg"' in (tmp_path / "units.csv").read_text()


def test_a_result_is_opened_as_xarray_opens_it(tmp_path):
    angles = {"angle": Coordinate("a.x", 2.0, Quantity("rad", "angle", display_unit="deg"))}
    with ResultFile(tmp_path / "result.nc", {"scenario": "test"}, angles) as file:
        quantities = {"a.x": Quantity("m", "x"), "a/y": Quantity("1", "kind", choices=("one", "two"))}
        file.write("coupled", np.arange(3.0), quantities, np.arange(6.0).reshape(3, 2))
        file.write("steps", np.zeros(0), {"a.x": Quantity("m", "x")}, np.zeros((0, 1)))
        assert (file.has("coupled"), file.has("steps")) == (True, False)
        file.attribute("coupled", "tolerance", 1e-6)
        file.write_profiles("contact", np.arange(2.0), {"film": ("m", np.ones((2, 4)))})
        file.finish(True, "")
    theirs = xarray.open_datatree(tmp_path / "result.nc", engine="h5netcdf")
    with theirs, open_result(tmp_path) as own:
        assert own["coupled"]["a.x"][1:].values.tolist() == [2.0, 4.0]
        xarray.testing.assert_identical(own, theirs)


@pytest.mark.parametrize("every", [1, 3])
def test_round_trip_through_xarray(tmp_path, every):
    steps = 2 * CHUNK + 5
    _record(tmp_path, QUANTITIES, ([i, -i] for i in range(steps + 1)), every)
    with ResultFile(tmp_path / "result.nc", {"scenario": "test"}) as file:
        for name, journal in journals(tmp_path).items():
            file.take(name, Recorded(journal))
        file.finish(True, "")
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


@pytest.mark.parametrize("count", [3, 5500])
def test_a_result_has_any_number_of_variables(count, tmp_path):
    """HDF5's list of what is attached to a dimension ends at 5400 or so."""
    names = [f"a.v{i}" for i in range(count)]
    with ResultFile(tmp_path / "result.nc", {}) as file:
        quantity = Quantity("m", "length")
        file.write(
            "coupled", np.arange(2.0), dict.fromkeys(names, quantity), np.tile(np.arange(count), (2, 1))
        )
        assert file.read("coupled", names[-1:], slice(None))[names[-1]].tolist() == [count - 1.0] * 2
        file.finish(True, "")
    with open_result(tmp_path) as tree:
        assert len(tree["coupled"].to_dataset().load()) == count
    with h5py.File(tmp_path / "result.nc") as found:
        assert len(found["coupled"]) == count + 1
        last = found[f"coupled/{names[-1]}"]
        assert last.dims[0][0] == found["coupled/time"]
        assert last.attrs["units"] == "m"
        np.testing.assert_array_equal(last[:], count - 1.0)


def test_csv_is_in_cross_check_layout_exact_and_has_its_units_beside_it(tmp_path):
    values = [1.0 / 3.0, 1e-300]
    _record(tmp_path, QUANTITIES, [values] * (2 * ROWS + 3), every=2)
    recorded = Recorded(journals(tmp_path)["coupled"])
    write_csv(tmp_path / "out.csv", tmp_path / "units.csv", recorded, {})
    with (tmp_path / "out.csv").open() as file:
        first = file.readline().strip()
        rows = [[float(text) for text in row] for row in csv.reader(file)]
    assert first == '"time","contact.load","spring.coil_position[1]"'
    assert rows == [[1e-6 * i, *values] for i in range(0, 2 * ROWS + 3, 2)]
    with (tmp_path / "units.csv").open() as file:
        units = {row["variable"]: row["unit"] for row in csv.DictReader(file)}
    assert units == {"time": "s", **{name: quantity.unit for name, quantity in QUANTITIES.items()}}


def _in_a_process(code: str) -> subprocess.CompletedProcess[str]:
    root = Path(__file__).parents[2]
    script = textwrap.dedent(code)
    return subprocess.run(
        [sys.executable, "-c", script], cwd=root, capture_output=True, text=True, timeout=100
    )


@pytest.mark.parametrize(("head", "mark"), [("film [µm]", b"\xef\xbb\xbf"), ("film [m]", b"")])
def test_a_spreadsheet_takes_a_table_for_utf_8(head, mark, tmp_path):
    """By its byte order mark; a table of ASCII is the same without."""
    write_rows(tmp_path / "table.csv", [[head], [1.5]])
    assert (tmp_path / "table.csv").read_bytes() == mark + f"{head}\n1.5\n".encode()


def test_what_was_flushed_survives_a_killed_process(tmp_path):
    done = _in_a_process(f"""
        import os
        import numpy as np
        from pathlib import Path
        from orchestrator.store.journal import HELD
        from orchestrator.run.record import ResultRecorder
        from orchestrator.stepping import Step
        from tests.orchestrator.test_results import QUANTITIES
        recorder = ResultRecorder(Path({str(tmp_path)!r}), QUANTITIES, 1)
        recorder.begin(list(QUANTITIES))
        for i in range(HELD + 7):
            recorder.observe(1e-6 * i, np.array([i, 0.0]).copy, Step(1e-6 * i, 1.0, 1))
        os._exit(9)
    """)
    assert done.returncode == 9
    recorded = Recorded(journals(tmp_path)["coupled"])
    assert recorded.rows >= HELD
    rows = np.concatenate(list(recorded.blocks(1000)))
    assert np.array_equal(rows[:, 1], np.arange(recorded.rows))
    assert recorded.columns["contact.load"] == QUANTITIES["contact.load"]


@pytest.mark.skipif(sys.platform == "win32", reason="limits the size of files")
@pytest.mark.parametrize("room", [0, 1, 23, 24, 1000])
def test_of_a_journal_without_room_all_whole_rows_are_kept_and_its_name_is_told(tmp_path, room):
    """The process may write `room` bytes after the header: a write is cut short as on a full disk."""
    done = _in_a_process(f"""
        import resource, signal
        import numpy as np
        from pathlib import Path
        from orchestrator.store.journal import Journal
        from tests.orchestrator.test_results import QUANTITIES
        path = Path({str(tmp_path / "coupled.journal")!r})
        journal = Journal(path, QUANTITIES)
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        most = path.stat().st_size + {room}
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
        for i in range(100):
            journal.append(i, np.array([i, -i]))
        for write in (journal.flush, journal.close):
            try:
                write()
            except OSError as error:
                print(error.filename)
    """)
    assert done.stdout.splitlines() == [str(tmp_path / "coupled.journal")], done.stderr
    recorded = Recorded(tmp_path / "coupled.journal")
    assert recorded.rows == room // 24
    assert recorded.last_time() == (room // 24 - 1 if room >= 24 else None)
    rows = np.concatenate([np.zeros((0, 3)), *recorded.blocks(10)])
    assert np.array_equal(rows, np.outer(np.arange(room // 24), [1, 1, -1]))
    assert (tmp_path / "coupled.journal").read_bytes().split(b"\n", 1)[1] == rows.tobytes()


def _mark(path: Path, rows: int) -> Mark:
    return {"rows": rows, "checksum": Recorded(path).compute_checksum(rows)}


def _filled(path: Path, rows: range, mark: Mark | None = None) -> bytes:
    journal = Journal(path, QUANTITIES, mark)
    for i in rows:
        journal.append(1e-6 * i, np.array([i, -i]))
    journal.close()
    return path.read_bytes()


@pytest.mark.parametrize("cut", [0, 1, 7, 8, 23, 24, 100])
def test_a_journal_cut_anywhere_has_its_whole_rows_and_goes_on_after_any_of_them(tmp_path, cut):
    """Round trip: what is cut off (bytes) and written again is the journal that was never cut."""
    path = tmp_path / "coupled.journal"
    whole = _filled(path, range(50))
    path.write_bytes(whole[: len(whole) - cut])
    recorded = Recorded(path)
    assert recorded.rows == 50 - -(-cut // 24)  # rows of three doubles
    assert sum(len(block) for block in recorded.blocks(7)) == recorded.rows
    for at in (0, recorded.rows // 2, recorded.rows):
        path.write_bytes(whole[: len(whole) - cut])
        assert _filled(path, range(at, 50), _mark(path, at)) == whole


def test_a_journal_that_lacks_rows_or_is_another_is_refused(tmp_path):
    path = tmp_path / "coupled.journal"
    whole = _filled(path, range(50))
    with pytest.raises(JournalError, match="has 50 rows, of 51 at the checkpoint"):
        Journal(path, QUANTITIES, _mark(path, 51))
    with pytest.raises(JournalError, match="other columns"):
        Journal(path, {"contact.load": QUANTITIES["contact.load"]}, _mark(path, 50))
    assert path.read_bytes() == whole
    for spoilt in (b"", b"{}\n", b"\xff\xfe", b'{"format": "tribocosim journal 0"}\n'):
        path.write_bytes(spoilt)
        with pytest.raises(JournalError, match="not a journal of this version"):
            Recorded(path)
    path.write_bytes(whole[:40])  # killed while the header was written
    assert journals(tmp_path) == {}


def test_a_result_appears_only_when_it_is_whole(tmp_path):
    def make(finished):
        with ResultFile(tmp_path / "result.nc", {}) as file:
            file.write("steps", np.arange(3.0), {"a": Quantity("m", "x")}, np.zeros((3, 1)))
            if finished:
                file.finish(True, "")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        make(False)
    assert not list(tmp_path.iterdir())
    with pytest.raises(KeyboardInterrupt):
        make(True)
    assert [path.name for path in tmp_path.iterdir()] == ["result.nc"]
    with open_result(tmp_path) as tree:
        assert tree["steps"].sizes["time"] == 3


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="reads Linux's memory figures")
def test_memory_does_not_grow_with_the_steps(tmp_path):
    """A hundred thousand macro steps of 45 outputs would be 37 MB of doubles."""
    done = _in_a_process(f"""
        import numpy as np
        from pathlib import Path
        from models.core.quantities import Quantity
        from orchestrator.run.record import ResultRecorder
        from orchestrator.stepping import Step
        from orchestrator.store.journal import Recorded
        from orchestrator.store.result_file import ResultFile
        names = [f"a.v{{i}}" for i in range(45)]
        folder = Path({str(tmp_path)!r})
        recorder = ResultRecorder(folder, {{name: Quantity("m", "x") for name in names}}, 1)
        recorder.begin(names)
        values = np.random.default_rng(1).random(45)
        def peak():
            # Not getrusage: its peak comes along from the process that started this one.
            status = Path("/proc/self/status").read_text()
            return int(status.split("VmHWM:")[1].split()[0]) / 1024.0
        for i in range(100_000):
            recorder.observe(1e-6 * i, values.copy, Step(1e-6 * i, 1.0, 1))
            if i == 20_000:
                before = peak()
        recorder.end(True, "")
        with ResultFile(folder / "result.nc", {{}}) as file:
            file.take("coupled", Recorded(folder / "coupled.journal"))
            file.finish(True, "")
        print(peak() - before)
    """)
    # Blocks, and index nodes of the file, of which HDF5 keeps some.
    assert float(done.stdout) < 20.0


def _run(out: Path, *changes: str, scenario: str = "valve-train") -> Summary:
    quiet = Reporter(Console(quiet=True))
    overrides = [*changes, *(HERE if scenario == "valve-train" else [])]
    return run(load(scenario, overrides), out, build_fmu, quiet, figures=False)


def test_the_end_of_a_run_is_recorded_wherever_it_falls(tmp_path):
    """100 macro steps with a record after each 30, in every group."""
    changes = ["stop_time=0.1 s", "output_step=30 ms", "reference.enabled=false", "energy.ledger=true"]
    summary = _run(tmp_path / "out", *changes, scenario="quarter-car")
    assert summary.macro_steps == 100
    with open_result(tmp_path / "out") as tree:
        for group in ("coupled", "energy"):
            assert tree[group]["time"].values == pytest.approx([0.0, 0.03, 0.06, 0.09, 0.1], rel=1e-12)
            assert tree[group]["time"].values[-1] == 0.1
    assert summary.energy
    assert summary.energy.until == 0.1


def test_rare_records_do_not_hide_an_error_from_the_comparison(tmp_path):
    """With inputs held the load chatters, by more than its own size. Compared at t = 0, 14 ms, 28 ms it was
    0.7 % off. The error found is the one of all macro steps, up to three standard errors of an RMS estimated
    from n values (1 / sqrt(2 n) each)."""
    changes = ["master.extrapolation=hold", "stop_time=30 ms"]
    rare = _run(tmp_path / "rare", *changes, "output_step=14 ms")
    every = _run(tmp_path / "every", *changes, "output_step=5 us")
    assert rare.exit_status == every.exit_status == OUTSIDE
    with open_result(tmp_path / "rare") as tree:
        times = tree["coupled"]["time"].values
    assert times[-1] == 30e-3
    assert len(times) > 100
    assert np.diff(times).max() <= 0.3e-3 * (1.0 + 1e-9)
    found, whole = (summary.errors["contact.load"].relative_rms for summary in (rare, every))
    assert found == pytest.approx(whole, rel=3.0 / np.sqrt(2.0 * len(times)))
    assert whole > 1.0


def test_every_step_of_very_many_ends_after_it_began():
    """Of 3e7 steps the rounding of time / macro_step is above the slack of few: steps of no length came of
    it."""
    steps = FixedSteps(5e-6)
    steps._start, steps._stop = 0.0, 1e6
    for n in range(30_000_000, 30_000_100):
        end, _ = steps._find_end(n * 5e-6)
        assert end == (n + 1) * 5e-6
