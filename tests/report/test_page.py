"""report.html: what is in the file, without a browser."""

import base64
import html
import json
import math
import re
import shlex
import zlib
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
import xarray
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import tribocosim
from models.core.quantities import Quantity
from orchestrator.report import write_report
from orchestrator.report.content import rank_variables
from orchestrator.report.cycle import find_abscissa
from orchestrator.report.mechanism import list_sketches
from orchestrator.report.packing import COARSE, DIVISIONS, PRECISE, bucket, pack, pack_detail, pack_exactly
from orchestrator.report.sketch import Sketch
from orchestrator.scenario.files import list_shipped, load
from orchestrator.scenario.system import build_system
from orchestrator.store.result_file import ResultFile, open_result

from ..orchestrator.commands import called
from .large import write_large

SPEEDS = np.array([100.0, 200.0, 300.0])
ROWS = 181


def load_of(speed: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Of the contact (N)."""
    return np.asarray(speed * (1.5 + np.cos(angle)))


def write_sweep(folder: Path) -> None:
    """The files that `tribocosim speeds` leaves, without a scenario."""
    share = np.linspace(0.0, 1.0, ROWS)
    angle = np.broadcast_to(2.0 * math.pi * share, (len(SPEEDS), ROWS))
    load = load_of(SPEEDS[:, None], angle)
    dims, film = ("speed", "share"), {"units": "m", "display_units": "um", "long_name": "film"}
    cycles = xarray.Dataset(
        {
            "cam_angle": (dims, angle, {"units": "rad"}),
            "contact.load": (dims, load, {"units": "N", "long_name": "contact load"}),
            "contact.film_thickness": (dims, 1e-6 / load, film),
        },
        {"speed": SPEEDS, "share": share},
        {"cam_ratio": 0.5},
    )
    cycles.to_netcdf(folder / "cycles.nc", engine="h5netcdf")
    numbers = xarray.Dataset(
        {
            "contact.least_load": ("speed", load.min(axis=1), {"units": "N", "long_name": "least load"}),
            "contact.lost": ("speed", [0.0, 0.0, 0.1]),
            "valve.bounce": ("speed", np.full(len(SPEEDS), np.nan), {"units": "m"}),
            "status": ("speed", np.ones(len(SPEEDS), np.int8)),
        },
        {"speed": SPEEDS},
    )
    numbers.to_zarr(folder / "speeds.zarr", zarr_format=2, consolidated=True)
    separation = {"speed": 2700.0, "text": "contact is lost from 2700.0 r/min"}
    (folder / "summary.json").write_text(json.dumps({"scenario": "made", "separation": separation}), "utf-8")


EVIL = "</script><script>window.evil = 1</script>"


def unpack(text: str, size: int) -> Any:
    """As series.js does."""
    kind = {4: np.float32, 8: np.float64}[size]
    flat = np.frombuffer(zlib.decompress(base64.b64decode(text)), np.uint8)
    return np.ascontiguousarray(flat.reshape(size, -1).T).view(kind).ravel()


@given(
    hnp.arrays(np.float64, st.integers(1, 50), elements=st.floats(-1e30, 1e30)),
    st.sampled_from([PRECISE, COARSE]),
)
def test_packed_numbers_come_back_within_half_a_bit(values: Any, bits: int) -> None:
    """Relative to their size; what float32 has no exponent for becomes 0."""
    found = unpack(pack(values, bits), 4).astype(float)
    assert np.all(np.abs(found - values) <= np.abs(values) * (2.0 ** -(bits + 1) + 2.0**-23) + 1e-37)
    special = np.array([math.nan, math.inf, -math.inf, 0.0, 3.4028234e38])
    np.testing.assert_equal(unpack(pack(special), 4), special.astype(np.float32))


def test_a_page_without_room_for_all_keeps_what_roles_promise() -> None:
    """The lift of the valve before every flag and every force on a pivot."""
    scenario = load("pushrod-train")
    system = build_system(scenario)
    ranked = list(rank_variables(list(system.outputs.names), scenario, [], {}))
    promised = [
        "valve_spring.valve_lift",
        "valve_spring.position",
        "tappet.position",
        "cam_contact.film_ratio",
    ]
    others = [name for name in ranked if name.endswith(("_in_range", "next_event", "thermal_reduction"))]
    assert len(others) > 3
    assert max(map(ranked.index, promised)) < min(map(ranked.index, others))


ROUNDED = st.floats(-1e3, 1e3).map(lambda value: round(value, 9))  # no ranges below the normal numbers


@given(hnp.arrays(np.float64, st.integers(1, 50)))
def test_times_come_back_to_the_bit(values: Any) -> None:
    assert unpack(pack_exactly(values), 8).tobytes() == values.tobytes()


@given(hnp.arrays(np.float64, st.integers(1, 200), elements=ROUNDED))
def test_every_row_comes_back_within_half_a_part_of_the_range(values: Any) -> None:
    """As unpackDetail in series.js sums the second differences."""
    packed = pack_detail(values)
    second = unpack(packed["text"], 4).view(np.int32)
    found = packed["least"] + packed["step"] * np.cumsum(np.cumsum(second))
    assert np.all(np.abs(found - values) <= 0.5 * packed["step"] * (1.0 + 1e-9) + 1e-12)
    assert packed["step"] * DIVISIONS >= np.ptp(values) * (1.0 - 1e-12)


@given(hnp.arrays(np.float64, st.integers(1, 200), elements=st.floats(-1e3, 1e3)), st.integers(1, 20))
def test_stretches_keep_the_extremes(values: Any, size: int) -> None:
    low, high = bucket(values, size)
    assert len(low) == math.ceil(len(values) / size)
    assert low.min() == values.min()
    assert high.max() == values.max()


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Of a short run whose title is an attack."""
    folder = tmp_path_factory.mktemp("run") / "out"
    scenario = tribocosim.load("valve-train").with_(
        {"stop_time": "4 ms", "description": EVIL, "reference.enabled": False}
    )
    tribocosim.run(scenario, folder)
    return write_report(folder).read_text("utf-8")


def read_content(page: str) -> Any:
    """What the scripts of a page get."""
    return json.loads(page.split('id="data">')[1].split("</script>")[0])


def read_command(page: str) -> list[str]:
    """The words of the command with which it is repeated."""
    return shlex.split(html.unescape(page.split('id="command">')[1].split("<")[0]))


def write_evil(folder: Path) -> Path:
    """A page of a result whose every text is an attack."""
    evil = {
        f"{EVIL}.load": Quantity(EVIL, EVIL, display_unit=""),
        f"{EVIL}.film_thickness": Quantity("m", EVIL),
    }
    attributes = {"scenario": EVIL, "versions": EVIL, "title": EVIL, "scenario_toml": EVIL}
    with ResultFile(folder / "result.nc", attributes) as made:
        made.write(
            "coupled", np.linspace(0.0, 1.0, 5), evil, np.array([[1, 1], [0, 1], [0, 1], [1, 1], [2, 1.0]])
        )
        made.finish(True, EVIL)
    bond = {"exchanged": 1.0, "created": 0.0, "largest_created": 0.0, "relative": 0.0}
    error = {"max_abs": 0.0, "rms": 0.0, "relative_rms": 0.0, "reference_uncertainty": 0.0, "tolerance": None}
    summary = {
        "complete": True, "scenario": EVIL, "verdict": EVIL, "largest_error": EVIL, "version": EVIL,
        "fmus": {EVIL: EVIL}, "notices": [EVIL], "errors": {EVIL: error},
        "energy": {"bonds": {EVIL: bond}, "components": {}, "created": 0.0, "outside_bonds": 0.0},
    }  # fmt: skip
    (folder / "summary.json").write_text(json.dumps(summary), "utf-8")
    return write_report(folder)


def test_no_text_of_a_result_becomes_markup(tmp_path: Path) -> None:
    """Names, units, descriptions, messages, scenario."""
    page = write_evil(tmp_path).read_text("utf-8")
    assert EVIL not in page
    assert page.count("<script") == page.count("</script>") == 2
    content = read_content(page)
    assert {v["unit"] for v in content["variables"]} == {EVIL.replace(".", " "), "m"}
    (mark,) = content["marks"]
    assert mark | {"lost": []} == {"part": EVIL, "kind": "load", "variable": f"{EVIL}.load", "lost": []}


def test_profiles_across_a_contact_are_in_the_page(tmp_path: Path) -> None:
    """Rounded to COARSE bits, instant by instant."""
    position = np.outer([1.0, 2.0, 4.0], np.linspace(-1e-4, 1e-4, 5))
    film = 1e-6 + position**2
    with ResultFile(tmp_path / "result.nc", {}) as made:
        made.write("coupled", np.linspace(0.0, 1.0, 3), {"contact.load": Quantity("N", "")}, np.ones((3, 1)))
        profiles = {"position": ("m", position), "pressure": ("Pa", 1e9 - film), "film": ("m", film)}
        made.write_profiles("contact", np.linspace(0.0, 1.0, 3), profiles)
        made.finish(True, "")
    told = read_content(write_report(tmp_path).read_text("utf-8"))["profiles"]["contact"]
    assert (told["rows"], told["nodes"]) == position.shape
    assert unpack(told["film"], 4).reshape(position.shape) == pytest.approx(
        1e-6 + position**2, rel=2.0**-COARSE
    )
    assert unpack(told["time"], 8).tolist() == [0.0, 0.5, 1.0]


def test_a_contact_without_load_has_a_gap_and_no_film(tmp_path: Path) -> None:
    """Film and its error are left out; the gap is the distance of the surfaces, which are in the page."""
    load_, film = np.array([[0.0, 5.0, 0.0]]).T, np.array([[4e-7, 5e-7, 6e-7]]).T
    names = {"contact.load": Quantity("N", ""), "contact.film_thickness": Quantity("m", "")}
    with ResultFile(tmp_path / "result.nc", {}) as made:
        made.write("coupled", np.linspace(0.0, 1.0, 3), names, np.hstack([load_, film]))
        made.finish(True, "")
    variables = read_content(write_report(tmp_path).read_text("utf-8"))["variables"]
    (packed,) = (v["data"]["values"] for v in variables if v["name"] == "contact.film_thickness")
    np.testing.assert_allclose(unpack(packed, 4), [np.nan, 5e-7, np.nan], rtol=2.0**-PRECISE)
    for name in ("valve-train", "pushrod-train", "roller-finger"):
        drawn, system = sketch(name), build_system(load(name))
        drivers = {str(c.target): str(c.source) for c in system.connections}
        for contact in (one for each in drawn for one in each.contacts):
            for end in ("approach", "retreat"):
                if source := drivers.get(f"{contact['title']}.{end}"):
                    assert contact["variables"].get(end) == source


def test_steps_have_their_reason_and_connection_and_bonds_their_energy(tmp_path: Path) -> None:
    """Of a run whose steps are controlled; the shares of what set them add up to all."""
    scenario = tribocosim.load("two-masses").with_(
        {"stop_time": "2 s", "reference.enabled": False, "energy.ledger": True, "step_control.relative": 1e-4}
    )
    tribocosim.run(scenario, tmp_path / "out")
    page = write_report(tmp_path / "out").read_text("utf-8")
    words = [kind["words"] for kind in read_content(page)["steps"]["kinds"]]
    assert any(text.startswith("error of first.force -> second.force: ") for text in words), words
    shares = [float(re.search(r": ([\d.]+) ?%", text)[1]) for text in words]  # type: ignore[index]
    assert sum(shares) == pytest.approx(100.0, abs=1.0)
    assert "Energy by connection" in page
    assert 'data-plot="energy: created ' in page


@pytest.mark.parametrize(("rows", "variables", "most"), [(24_000, 53, 4e6), (1_000_000, 8, 10e6)])
def test_large_runs_stay_small(rows: int, variables: int, most: float, tmp_path: Path) -> None:
    write_large(tmp_path, rows, variables)
    assert write_report(tmp_path).stat().st_size < most


def test_pictures_that_fail_do_not_end_the_run_and_are_drawn_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whether by themselves or by Ctrl-C: the run is complete, and all others are drawn."""
    out = tmp_path / "out"
    run = ("run", "two-masses", "--set", "stop_time=0.1 s", "--out", str(out))
    broken = {"report": "report.page.collect_run", "figure solution": "plots.solution.draw"}
    broken["figure steps"] = "plots.steps.applies"

    def call(*command: str, error: BaseException) -> tuple[int, str, dict[str, Any]]:
        """While all these fail: status, what is printed, and the summary of the run."""
        with monkeypatch.context() as failing:
            for place in broken.values():
                failing.setattr(f"orchestrator.{place}", Mock(side_effect=error))
            done = called(*command)
        return done.returncode, done.stdout + done.stderr, json.loads((out / "summary.json").read_text())

    for command, expected in ((run, 0), (("report", str(out)), 3)):
        status, printed, summary = call(*command, error=ZeroDivisionError("of it"))
        assert (status, summary["complete"], summary["exit_status"]) == (expected, True, 0)
        for what in broken:
            line = f"no {what}: unexpected ZeroDivisionError: of it; once that is mended, tribocosim report"
            assert f"{line} {out} draws it anew" in printed
        assert [path.name for path in (out / "figures").iterdir()] == ["difference.png"]
    status, printed, summary = call(*run, "--overwrite", error=KeyboardInterrupt())
    assert (status, summary["complete"], summary["exit_status"]) == (130, True, 0)
    assert f"all numbers are written, tribocosim report {out} draws figures and report" in printed
    assert called("resume", str(out)).returncode == 0  # there is nothing to continue
    assert called("report", str(out)).returncode == 0
    assert {path.name for path in (out / "figures").iterdir()} == {"difference.png", "solution.png"}
    assert (out / "report.html").exists()


def test_a_sweep_has_all_its_cycles(tmp_path: Path) -> None:
    """Loads to five digits; what is NaN at all speeds is left out."""
    write_sweep(tmp_path)
    page = write_report(tmp_path).read_text("utf-8")
    assert read_command(page)[-2:] == ["--out", f"{tmp_path}-again"]
    content = read_content(page)
    packed = {
        v["name"]: unpack(v["data"]["values"], 4).reshape(len(SPEEDS), ROWS) for v in content["variables"]
    }
    found = load_of(SPEEDS[:, None], packed["cam_angle"].astype(float))
    np.testing.assert_allclose(packed["contact.load"], found, rtol=4e-5)
    # At half the speed of the drive, a turn of the cam takes twice its period.
    np.testing.assert_allclose(content["sweep"]["periods"], 4.0 * math.pi / SPEEDS)
    names = [one["name"] for one in content["sweep"]["numbers"]]
    assert names == ["contact.least_load", "contact.lost"]


def test_the_page_asks_nothing_of_any_network_and_has_the_scenario_as_text(page: str) -> None:
    """No address in any attribute, no import; the policy in its head forbids what would."""
    addresses: list[str] = []

    class Parser(HTMLParser):
        def handle_starttag(self, tag: str, attrs: Any) -> None:
            addresses.extend(f"{tag} {key}" for key, _ in attrs if key in ("src", "href", "srcset", "data"))

    Parser().feed(page)
    assert addresses == []
    assert "default-src 'none'" in page
    assert 'class="verdict "' in page  # neither good nor bad: the run is not compared
    assert EVIL not in page
    assert "stop_time = 0.004" in page  # to repeat the run
    assert "SHA-256 of camshaft" in page
    outside = re.findall(r"https?://[^\s\"'<]+", page)
    assert set(outside) <= {"http://www.w3.org/2000/svg"}


def test_the_command_of_a_page_makes_the_result_again_beside_it(tmp_path: Path) -> None:
    short = {"stop_time": "50 ms", "reference.enabled": False}
    own = tmp_path / "its own"
    tribocosim.run(tribocosim.load("two-masses").with_(short), own)
    tool, *command = read_command(write_report(own).read_text("utf-8"))
    done = called(*command)
    assert (tool, done.returncode) == ("tribocosim", 0), done.stderr
    with open_result(own) as first, open_result(tmp_path / "its own-again") as second:
        xarray.testing.assert_equal(first["coupled"], second["coupled"])


def test_a_result_without_folder_has_a_page(tmp_path: Path) -> None:
    result = tribocosim.run(
        tribocosim.load("two-masses").with_({"stop_time": "50 ms", "reference.enabled": False})
    )
    assert result.folder is None
    path = result.report(tmp_path / "page.html")
    assert "two-masses" in path.read_text("utf-8")
    with pytest.raises(tribocosim.MistakeError, match=r"cannot be written"):
        result.report(tmp_path / "absent" / "page.html")


DRAWN = {
    "valve-train": 1, "pushrod-train": 1, "direct-acting-hla": 1, "finger-follower-hla": 1,
    "finger-follower": 1, "roller-finger": 1,
    "slider-crank": 1, "piston-slap": 1, "valve-stem": 1, "pushrod-engine": 8, "engine": 2, "quarter-car": 0,
    "valve-train-16v": 16,
}  # fmt: skip


def sketch(name: str) -> list[Sketch]:
    scenario = load(list_shipped()[name])
    return list_sketches(scenario, build_system(scenario).outputs.names)


@pytest.mark.parametrize("name", DRAWN)
def test_mechanisms_are_drawn(name: str) -> None:
    """Every variable that moves one is an output, every node is of a frame that there is."""
    outputs = build_system(load(list_shipped()[name])).outputs.names
    sketches = sketch(name)
    assert len(sketches) == DRAWN[name]
    for one in sketches:
        assert one.variables <= set(outputs)
        content = json.loads(json.dumps(one.content()))
        frames = len(content["frames"])
        for shape in content["shapes"]:
            assert all(node[0] < frames and (len(node) == 3 or node[1] < frames) for node in shape["nodes"])


def place(one: Sketch, shape: dict[str, Any], values: dict[str, float]) -> np.ndarray:
    """The points of a shape where the variables have these values: as scene.js does."""
    points = []
    for frame, x, y in shape["nodes"]:
        own = one.frames[frame]
        angle = sum(factor * values.get(name, 0.0) for name, factor in own.get("turn", ()))
        a, b = own.get("about", (0.0, 0.0))
        c, s = math.cos(angle), math.sin(angle)
        dx = sum(fx * values.get(name, 0.0) for name, fx, _ in own.get("shift", ()))
        dy = sum(fy * values.get(name, 0.0) for name, _, fy in own.get("shift", ()))
        points.append((a + c * (x - a) - s * (y - b) + dx, b + s * (x - a) + c * (y - b) + dy))
    return np.array(points)


@pytest.mark.parametrize(
    ("scenario", "angle"),
    [
        ("valve-train", "camshaft.cam_angle"),
        ("finger-follower", "finger.profile_angle"),
        ("pushrod-train", "tappet.profile_angle"),
        ("slider-crank", ""),
    ],
)
def test_cycles_are_drawn_over_the_angle_of_a_cam(scenario: str, angle: str) -> None:
    system = build_system(load(list_shipped()[scenario]))
    assert find_abscissa(system, system.outputs.names) == angle


@pytest.mark.parametrize("angle", [2.2, 2.8, math.pi, 3.6])
def test_the_drawn_cam_touches_its_flat_follower(angle: float) -> None:
    """The highest point of the turned contour is base circle and lift: the face of the bucket."""
    (one,) = sketch("valve-train")
    scenario = load(list_shipped()["valve-train"])
    component = scenario.components["camshaft"].resolve()
    layout = component.parameters
    y = component.outputs.vector()
    u = component.inputs.vector({"drive_angle": angle})
    p = layout.vector()
    component.flat_output(0.0, component.state.vector(), u, p, y)
    found = component.outputs.named(y)
    values = {"camshaft.cam_angle": found["cam_angle"], "valve_spring.position": found["cam_lift"]}
    cam = next(s for s in one.shapes if s["kind"] == "cam")
    bucket_face = next(s for s in one.shapes if s["kind"] == "body")
    top = place(one, cam, values)[:, 1].max()
    assert top == pytest.approx(place(one, bucket_face, values)[:, 1].min(), abs=0.02)
    assert top == pytest.approx(1e3 * (layout.named(p)["base_radius"] + found["cam_lift"]), abs=0.02)
