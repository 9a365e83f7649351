"""report.html in a real browser."""

import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

import tribocosim
from models.core.quantities import Quantity
from orchestrator.report import write_report
from orchestrator.store.result_file import ResultFile

from .large import write_large
from .test_page import SPEEDS, load_of, write_evil, write_sweep

# A browser that asks nothing of any network by itself.
QUIET = [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync",
]  # fmt: skip

playwright = pytest.importorskip("playwright.sync_api", reason="needs the package playwright")


@pytest.fixture(scope="module")
def browser():
    """Headless Chromium; skipped where there is none."""
    path = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if path is None:
        pytest.skip("needs chromium on the path")
    with playwright.sync_playwright() as driver:
        found = driver.chromium.launch(executable_path=path, args=QUIET)
        yield found
        found.close()


@contextmanager
def opened(browser: Any, path: Path, **options: Any) -> Iterator[Any]:
    """The page, ready; it must say nothing on the console and ask nothing of the network."""
    said: list[str] = []
    page = browser.new_page(viewport={"width": 1200, "height": 1000}, **options)
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("request", lambda request: said.extend([request.url] * (not request.url.startswith("file:"))))
    page.goto(path.as_uri())
    page.wait_for_selector("body[data-ready]", timeout=60_000)
    yield page
    assert said == []
    page.close()


def wait(page: Any, what: str) -> None:
    """Until an expression is true; the page's policy forbids playwright's own way."""
    for _ in range(300):
        if page.evaluate(what):
            return
        page.wait_for_timeout(100)
    raise AssertionError(f"never: {what}")


def settle(page: Any) -> None:
    """Wait for the next picture."""
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """A revolution and a half of the valve train, with its reference."""
    folder = tmp_path_factory.mktemp("run") / "out"
    found = tribocosim.run(tribocosim.load("valve-train").with_({"stop_time": "60 ms"}), folder)
    write_report(folder)
    return found


@pytest.fixture
def page(browser, result):
    with opened(browser, Path(result.folder, "report.html")) as found:
        yield found


@pytest.fixture
def sweep_page(browser, tmp_path):
    write_sweep(tmp_path)
    with opened(browser, write_report(tmp_path)) as found:
        yield found


def lowest(page: Any, title: str) -> float:
    """How far down on the page the shapes of that title reach (mm)."""
    paths = page.evaluate(
        f"[...document.querySelectorAll('svg path')].filter((p) => p.dataset.title === '{title}')"
        ".map((p) => p.getAttribute('d'))"
    )
    numbers = [float(y) for d in paths for y in re.findall(r"[ML]\S+ ([-\d.]+)", d)]
    return max(numbers)


def test_the_valve_stands_where_its_lift_says(page, result):
    """At three instants; the page rounds to a thousandth of a millimetre, and values to five digits."""
    lift = result.coupled["valve_spring.position"]
    page.evaluate("report.setTime(0)")
    settle(page)
    closed = lowest(page, "valve_spring") - 1e3 * float(lift[0])
    for time in (0.02, 0.03, 0.041):
        page.evaluate(f"report.setTime({time})")
        settle(page)
        at = int(np.searchsorted(lift["time"].values, time, side="right")) - 1
        assert lowest(page, "valve_spring") - closed == pytest.approx(1e3 * float(lift[at]), abs=3e-3)


def test_zoom_move_and_instant_go_through_all_plots(page):
    canvas = page.locator(".panel canvas").first
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 50)
    for _ in range(5):
        page.mouse.wheel(0, -100)
    page.wait_for_timeout(100)
    low, high = page.evaluate("report.view.shown")
    assert (high - low) == pytest.approx(360.0 * 0.8**5, rel=1e-4)  # degrees of the cam
    page.mouse.down()
    page.mouse.move(box["x"] + 0.5 * box["width"] - 100, box["y"] + 50, steps=4)
    page.mouse.up()
    assert page.evaluate("report.view.shown[0]") > low
    page.mouse.click(box["x"] + 0.7 * box["width"], box["y"] + 60)
    settle(page)
    shown = page.locator("#now").text_content()
    first, last = page.evaluate("report.view.shown")
    assert first < float(shown.split(", ")[1].split()[0]) < last
    page.mouse.dblclick(box["x"] + 0.7 * box["width"], box["y"] + 60)
    assert page.evaluate("report.view.shown") == pytest.approx([0.0, 360.0], rel=1e-5)
    page.evaluate("report.view.xs[0] = -1.4e-4; report.setTime(0)")
    assert page.locator("#now").text_content() == "0 ms, 0 deg"  # what rounding leaves is not said


def test_what_few_ask_for_is_behind_the_rest_in_lists_of_variables(page):
    groups = page.evaluate(
        "Object.fromEntries([...document.querySelector('.panel select').children].map((one) =>"
        " [one.label, [...one.children].map((each) => each.value)]))"
    )
    labels = list(groups)
    first = [label for label in labels if ", more" not in label and label != "steps"]
    assert max(map(labels.index, first)) < min(i for i, label in enumerate(labels) if ", more" in label)
    assert "contact.load" in groups["contact"]
    assert "contact.speed_in_range" in groups["contact, more"]


def test_keys_play_and_step(page):
    page.keyboard.press("ArrowRight")
    assert page.evaluate("report.now") == pytest.approx(2e-5)
    page.keyboard.press(" ")
    page.wait_for_timeout(300)
    page.keyboard.press(" ")
    assert page.evaluate("report.now") > 1e-4
    assert page.locator("#play").text_content() == "Play"


def test_what_is_shown_is_saved_as_csv(page, result):
    with page.expect_download() as download:
        page.click("#csv")
    header, *rows = Path(download.value.path()).read_text().splitlines()
    assert header.startswith('"time [s]","contact.load [N]","contact.load, reference [N]"')
    assert len(rows) == result.coupled.sizes["time"]
    columns = np.array([[float(text) for text in row.split(",")[1:3]] for row in rows])
    np.testing.assert_allclose(columns[:, 0], result.coupled["contact.load"].values, rtol=2e-5)
    assert result.reference is not None
    np.testing.assert_allclose(columns[:, 1], result.reference["contact.load"].values, rtol=2e-5)


def test_angles_take_the_place_of_time(browser, result):
    with opened(browser, Path(result.folder, "report.html"), color_scheme="dark") as page:
        assert page.evaluate("report.view.name") == "cam_angle"
        page.select_option("#abscissa", "camshaft.cam_angle")
        page.wait_for_timeout(300)
        assert page.evaluate("report.view.unit") == "deg"
        assert page.evaluate("report.view.whole[1]") == pytest.approx(360.0, rel=1e-4)


def test_keys_work_after_a_click_on_a_button(page):
    """What was reached by the keyboard keeps its keys: there, space presses a button."""
    page.click("#whole")
    page.keyboard.press("ArrowRight")
    assert page.evaluate("report.now") == pytest.approx(2e-5)
    before = page.locator(".panel").count()
    page.focus("#add")
    page.keyboard.press(" ")
    assert page.locator(".panel").count() == before + 1
    page.set_viewport_size({"width": 390, "height": 800})
    settle(page)
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    broken = """[...document.querySelectorAll('td')].filter((cell) => {
      const text = document.createRange(); text.selectNodeContents(cell);
      return new Set([...text.getClientRects()].map((line) => Math.round(line.top))).size > 1;
    }).map((cell) => cell.textContent)"""
    assert page.evaluate(broken) == []


def test_rounded_angles_that_rise_slowly_take_the_place_of_time(browser, tmp_path):
    """Rows a nanosecond apart, of a step control that locates events, have equal rounded angles. One that
    turns back cannot be an abscissa, and the page says so."""
    time = np.sort(np.concatenate([np.linspace(0.0, 0.12, 200), 0.06 + 1e-9 * np.arange(1, 50)]))
    angle = np.degrees(100.0 * time)
    rows = np.column_stack([angle, np.sin(angle), np.ones_like(angle)])
    rad = Quantity("deg", "angle")
    names = {"a.angle": rad, "a.swing_angle": rad, "a.load": Quantity("N", "load")}
    with ResultFile(tmp_path / "result.nc", {"scenario": "turning"}) as made:
        made.write("coupled", time, names, rows)
        made.finish(True, "")
    with opened(browser, write_report(tmp_path)) as page:
        page.select_option("#abscissa", "a.angle")
        wait(page, "report.view.name === 'a.angle'")
        xs = np.array(page.evaluate("Array.from(report.view.xs)"))
        assert np.all(np.diff(xs) > 0.0)
        np.testing.assert_allclose(xs, angle, rtol=2e-5)
        page.select_option("#abscissa", "a.swing_angle")
        wait(page, "document.getElementById('why').textContent.includes('does not turn one way')")
        assert page.evaluate("report.view.name") == "a.angle"


def test_a_million_rows_stay_few_marks(browser, tmp_path):
    """Drawn is at most some points for each pixel, whatever is shown; zoomed in, every row is there."""
    write_large(tmp_path, 1_000_000, 4)
    with opened(browser, write_report(tmp_path)) as page:
        wait(page, "report.panels.every((one) => one.detail)")
        page.evaluate(
            "() => { window.drawn = 0; for (const name of ['lineTo', 'fillRect']) {"
            "const plain = CanvasRenderingContext2D.prototype[name];"
            "CanvasRenderingContext2D.prototype[name] ="
            " function (...at) { drawn++; plain.apply(this, at); }; } }"
        )
        for factor in (1.0, 0.5, 0.1, 0.01):
            page.evaluate(f"drawn = 0; report.view.reset(); report.view.zoom(1.23, {factor})")
            settle(page)
            settle(page)
            assert 0 < page.evaluate("drawn") < 60_000
        # A single row that stands out is seen from afar, and at its place from near.
        page.evaluate("report.view.reset()")
        assert page.evaluate("report.panels[0].values.range(0, 24000)[1]") == pytest.approx(7.0, rel=1e-4)
        assert page.evaluate("report.panels[0].detail.at(125000)") == pytest.approx(7.0, abs=1e-3)
        assert page.evaluate("report.panels[0].detail.at(125001)") < 1.1


def test_rows_that_share_a_pixel_are_joined_to_the_row_before_by_one_line(sweep_page):
    """Rows far apart and then close together: no upright reaches down to the row that a line has left."""
    heights = sweep_page.evaluate(
        "(() => { const tall = [], none = () => {}, same = (v) => v;"
        "const g = { lineWidth: 1, beginPath: none, stroke: none, moveTo: none, lineTo: none,"
        " fillRect: (x, y, wide, high) => tall.push(Math.abs(high)) };"
        "const values = Float32Array.from([0, 5, 5.1, 5.2, 5.3, 6]), series = new Series(values, values);"
        "traceLine(g, { x: same, y: (v) => -v }, series, [0, 10, 10.1, 10.2, 10.3, 20], 1, 0, 6);"
        "return tall; })()"
    )
    assert heights
    assert max(heights) == pytest.approx(0.3 + 1.0, abs=1e-6)  # of the rows, and the line's thickness


def test_numbers_are_written_without_zeros_that_say_nothing(sweep_page):
    said = sweep_page.evaluate("[1e-4, 1.5e-4, 1.2344e6, -1e-10, 2e5, 0, 12.5, 100].map(readable)")
    assert said == ["1e-4", "1.5e-4", "1.234e+6", "-1e-10", "2e+5", "0", "12.5", "100"]


@pytest.mark.parametrize(("film", "said"), [(2e-10, "no film"), (4e-10, "film 4e-4 µm")])
def test_a_film_below_an_atom_is_said_to_be_none(browser, tmp_path, film, said):
    values = f"{{ load: 10, film_thickness: {film}, maximum_pressure: 1e8, half_width: 1e-5 }}"
    own = f"{{ value: (name) => ({values})[name], open: () => NaN, describeSource: () => '' }}"
    with opened(browser, write_evil(tmp_path)) as page:
        assert page.evaluate(f"Contact.prototype.describe.call({own}, 0)").startswith(f"load 10 N, {said}, ")


def test_no_text_of_a_result_runs(browser, tmp_path):
    """Of names, units, descriptions and messages that are scripts; the losses are marked all the same."""
    with opened(browser, write_evil(tmp_path)) as page:
        page.click("#add")
        page.click("#after")
        assert page.evaluate("window.evil") is None
        assert page.evaluate("report.marks.events.map((one) => one.time)") == [pytest.approx(0.75)]


def test_a_click_on_a_map_and_its_keys_choose_the_speed(sweep_page):
    settle(sweep_page)
    frame = sweep_page.evaluate("report.drawings.at(-1).views[0].frame")
    x = frame["left"] + 0.75 * (frame["right"] - frame["left"])
    sweep_page.click("#maps canvas", position={"x": x, "y": frame["top"] + 5})
    wait(sweep_page, "report.records.chosen === 2")
    sweep_page.wait_for_timeout(200)
    assert sweep_page.evaluate("report.view.at(report.now)") == pytest.approx(270.0, abs=2.5)
    load = sweep_page.evaluate("report.panels[0].values.at(report.row(0))")
    angle = sweep_page.evaluate("report.view.at(report.now)")
    assert load == pytest.approx(float(load_of(SPEEDS[2], np.radians(angle))), rel=1e-4)
    sweep_page.locator("#maps canvas").first.press("ArrowDown")
    wait(sweep_page, "report.records.chosen === 1")
    assert sweep_page.locator("#speeds").input_value() == "1"


def test_speeds_without_contact_are_pale(sweep_page):
    """And the scale is that of the other speeds, whose largest load is known; curves are shaded from the
    separation, between two speeds, and say where they have no number."""
    settle(sweep_page)
    assert sweep_page.evaluate("report.drawings.at(-1).told.edges")[2:] == [2700.0, SPEEDS[2] * 30 / np.pi]
    curve = "report.drawings.at(-1).views.at(-1)"
    sweep_page.evaluate(f"{curve}.number.values.fill(null) && {curve}.draw(0)")
    assert sweep_page.evaluate(f"{curve}.reading.textContent") == "none"
    first = "report.drawings.at(-1).views[0].picture.getContext('2d').getImageData(0, 0, 1, 3).data"
    assert sweep_page.evaluate(f"[...{first}].filter((_, at) => at % 4 === 3)") == [70, 255, 255]
    assert sweep_page.evaluate("report.drawings.at(-1).views[0].range[1]") == pytest.approx(
        float(load_of(SPEEDS[1], np.array(0.0))), rel=1e-6
    )
    assert sweep_page.locator("#pale").is_visible()


def test_an_open_contact_of_a_sweep_has_no_film(browser, tmp_path):
    """Neither in the plot nor in the map; plots off the screen follow the chosen speed too."""
    write_sweep(tmp_path)
    with xarray.open_dataset(tmp_path / "cycles.nc", engine="h5netcdf") as stored:
        cycles = stored.load()
    cycles["contact.load"][:, -1] = 0.0
    cycles.to_netcdf(tmp_path / "cycles.nc", engine="h5netcdf")
    with opened(browser, write_report(tmp_path)) as page:
        page.set_viewport_size({"width": 1200, "height": 100})
        page.locator("#speeds").select_option("2")
        wait(page, "report.records.chosen === 2 && report.panels.every((one) => one.key !== null)")
        page.evaluate("report.setTime(report.base.end)")
        wait(page, "report.panels[1].reading.textContent === 'no contact'")
        film = "report.drawings.at(-1).views[1]"
        assert page.evaluate(f"{film}.reading.textContent") == "no contact"
        last = f"{film}.picture.getContext('2d').getImageData({film}.picture.width - 1, 1, 1, 1).data[3]"
        assert (page.evaluate(last), page.evaluate(f"{film}.range.every(Number.isFinite)")) == (0, True)


def test_everything_has_a_name_for_screen_readers(page):
    """Every control and every picture."""
    nameless = page.evaluate(
        "[...document.querySelectorAll('canvas, svg, select, input, button')].filter((one) =>"
        " !one.getAttribute('aria-label') && !one.closest('label') && !one.textContent.trim())"
        ".map((one) => one.outerHTML)"
    )
    assert nameless == []


def test_paper_is_white(browser, result):
    """A page in dark colours is drawn in light ones for the printer, and back."""
    with opened(browser, Path(result.folder, "report.html"), color_scheme="dark") as page:
        dark = page.evaluate("color('paper')")
        page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
        assert page.evaluate("color('paper')") == "#ffffff"
        page.evaluate("window.dispatchEvent(new Event('afterprint'))")
        assert page.evaluate("color('paper')") == dark != "#ffffff"
