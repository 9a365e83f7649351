"""cycle.html: a page that computes the steady cycle of a train, in a real browser."""

import itertools
import math
import platform
import re
import shlex
import subprocess
from pathlib import Path

import numpy as np
import pytest

import tribocosim
from fmus.native.cycle_module import cycle_module, link_cycle, list_sizes
from fmus.native.machine_code import Platform
from models.catalogue import find_factory
from models.native.translate import TranslationError
from orchestrator.assessment.lost_contact import LOST, ContactLaw
from orchestrator.errors import MistakeError
from orchestrator.report.cycle import SAMPLES
from orchestrator.report.packing import list_spans
from orchestrator.scenario.files import load, read_changed
from orchestrator.scenario.system import list_parameters
from orchestrator.study.speeds.subject import SpeedSubject, measure_cycle
from tribocosim.scenario_fmus import write_whole

from .test_browser import browser as browser
from .test_browser import opened, wait

pytest.importorskip("ziglang", reason="needs the package ziglang")

NAMES = ("load", "film_thickness")
# What the host reads, in this order.
LISTED = ("parameters", "inputs", "state", "nominal", "held", "positive")


# Its temperature is none of those that every page has.
WARM = 'extends = "valve-train"\noil = "SAE 5W-30"\ntemperature = "93 degC"\n'


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """In a folder that is given for it."""
    folder = tmp_path_factory.mktemp("cycle")
    (folder / "warm.toml").write_text(WARM)
    assert tribocosim.report(folder / "warm.toml", folder, cycle=True) == folder / "cycle.html"
    return folder / "cycle.html"


def test_the_page_finds_the_cycle_that_the_monolithic_solver_finds(browser, path):
    """At another speed than the scenario's, by its slider. A thousandth is a fifth of a pixel of a plot."""
    with opened(browser, path) as page:
        slider = page.get_by_label("speed (r/min)", exact=True)
        slider.focus()
        page.evaluate("report.view.zoom(0.25 * report.view.whole[1], 0.5)")
        part = page.evaluate("report.view.part")
        for _ in range(4):
            slider.press("ArrowRight")
        wait(page, "document.querySelector('#sliders output').textContent === '1200 r/min'")
        wait(page, "report.records.period === 0.05 && report.base.end === 0.05")
        wait(page, "document.querySelector('#cycle-state').textContent.startsWith('steady after ')")
        found = {
            name: page.evaluate(f"Array.from(report.records.column('contact.{name}'))") for name in NAMES
        }
        told = page.locator("#cycle-figures").inner_text()
        sliders = {one["name"]: one for one in page.evaluate("report.records.told.sliders")}
        assert slider.get_attribute("aria-valuetext") == "1200 r/min"
        assert page.evaluate("report.view.part") == pytest.approx(part) != [0.0, 1.0]
        command = shlex.split(page.locator("#command").inner_text())
        assert command[:3] == ["tribocosim", "run", str(path.with_name("warm.toml"))]
        assert command[3:5] == ["--out", "results/warm-again"]
        repeated = list_parameters(load(command[2], command[6::2]))
        assert repeated["flywheel.initial_speed"] == pytest.approx(1200.0 * math.pi / 30.0)
        assert page.evaluate("get('verdict').className") == "verdict good"
        assert page.evaluate(
            "(() => { const slider = get('slider-0'); slider.value = slider.max; slider.oninput(); return ["
            "get('verdict').className, getComputedStyle(get('cycle-figures')).opacity]; })()"
        ) == ["verdict ", "0.35"]
        wait(page, "document.querySelector('#cycle-state').textContent.includes('steady after ')")
        assert page.evaluate("get('verdict').className") == "verdict unsteady"
        headline, figures = (page.locator(one).inner_text() for one in ("#verdict", "#cycle-figures"))
        highest, limit = map(float, re.findall(r"([\d.]+) MPa", headline))
        assert "contact is lost in contact; bodies yield above the elastic limit" in headline
        assert highest > limit == pytest.approx(1e-6 * repeated["contact.elastic_limit"], rel=1e-3)
        assert figures.startswith("contact is lost: least load while the cam lifts 0 N")
        thin = page.evaluate("report.records.lows.fill(2e-10) && report.records.measure().figures")
        assert "least film 0 µm" in thin  # below an atom
        clash = page.evaluate("report.records.lows.fill(-2e-3) && report.records.measure()")
        assert "least travel left to coil bind -2 mm (valve_spring)" in clash["figures"]
        beyond = "coils clash in valve_spring (the tightest 2 mm of travel beyond coil bind)"
        assert [line for line in clash["warnings"] if line.startswith("coils")] == [beyond]
        lifting = (
            "lash => { const chosen = report.records.view('parameters', Float64Array, report.records.told."
            "parameters.length); chosen[report.records.told.trains[0].lashes[0][0]] = lash; "
            "return report.records.measure().figures.includes('while the cam lifts'); }"
        )
        assert [page.evaluate(lifting, lash) for lash in (1.0, 0.0)] == [False, True]
        page.evaluate("report.records.told.parameters.fill(NaN)")
        slider.press("ArrowLeft")
        wait(page, "document.querySelector('#cycle-state').textContent.startsWith('no step succeeds: ')")
    oil = sliders["oil temperature"]
    own = oil["positions"][oil["at"]]
    assert (own["shown"], own["parameters"]) == (93.0, [])
    assert [one["shown"] for one in oil["positions"]] == sorted({93, *range(30, 155, 5)})
    subject = SpeedSubject(read_changed(str(path.with_name("warm.toml"))), "flywheel")
    cycle = subject.find_cycle_at(1200.0 * math.pi / 30.0)
    for name in NAMES:
        right = cycle[f"contact.{name}"][:: (len(cycle.times) - 1) // SAMPLES]
        assert np.abs(np.array(found[name]) - right).max() < 1e-3 * right.max(), name
    # Three digits, of the solver's own steps.
    least, film = (float(number) for number in re.findall(r"(\S+) (?:N|µm) \(contact\)", told))
    thinnest = cycle["contact.minimum_film_thickness"].min()
    assert least == pytest.approx(measure_cycle(cycle, "flywheel")["contact.least_load"], rel=6e-3)
    assert 1e-6 * film == pytest.approx(thinnest, rel=6e-3)
    hard = subject.find_cycle_at(6000.0 * math.pi / 30.0)
    assert 1e6 * highest == pytest.approx(hard["contact.maximum_pressure"].max(), rel=6e-3)


def test_the_page_finds_lost_contact_as_python_does_by_the_lash_of_its_slider(browser, path):
    """Of a rocker's train: the cam lifts by 0.8 times the lash, and by 8 mm."""
    random = np.random.default_rng(5)
    lifts = 8e-3 * np.maximum(0.0, np.sin(np.linspace(0.0, 4.0 * np.pi, 721)))
    loads = np.repeat(random.choice([0.0, 1e-10, 400.0], 103), 7)
    own = (
        "([lash, loads, lifts, rests]) => CycleRecords.prototype.findLost.call({ told: { parameters: [0], "
        "trains: [{ contacts: { c: 1 }, lift: 'lift', lobe: 8e-4, lashes: [[0, 0.8]], rests }] }, "
        "view: () => [lash], column: (name) => name === 'lift' ? lifts : loads, "
        "findLaw: CycleRecords.prototype.findLaw }, { part: 'c' })"
    )
    found = []
    with opened(browser, path) as page:
        for lash in (0.0, 0.3e-3, 2e-3):
            law = ContactLaw(0.8 * lash, max(0.8e-3, 0.8 * lash))
            found.append(page.evaluate(own, [lash, loads.tolist(), lifts.tolist(), True]))
            assert found[-1] == list_spans(law.judge(loads, lifts) == LOST)
        bare = page.evaluate(own, [0.0, loads.tolist(), lifts.tolist(), False])
    assert bare == list_spans(ContactLaw().judge(loads, lifts) == LOST)
    assert all(one != other for one, other in itertools.combinations([*found, bare], 2))


@pytest.mark.parametrize(
    ("key", "changed"),
    [("state", lambda first: "[1e999,"), ("positive", lambda flags: flags.replace("0", "1"))],
)
def test_where_no_step_succeeds_from_the_start_the_page_says_so(key, changed, browser, path, tmp_path):
    """From a state that is no number, or with states that must be above zero and are not."""
    lost = tmp_path / "lost.html"
    place = rf'(?<="{key}":)' + (r"\[[^,]*," if key == "state" else r"\[[^\]]*\]")
    text = re.sub(place, lambda found: changed(found[0]), path.read_text("utf-8"), count=1)
    lost.write_text(text, "utf-8")
    with opened(browser, lost) as page:
        assert page.locator("#cycle-state").inner_text() == "no step succeeds: there is no cycle"


@pytest.mark.long
@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="the host is for x86-64")
def test_a_browser_computes_the_bits_of_native_code(browser, path, tmp_path):
    """The same C and kernels for this machine, with the same mathematical library, musl's."""
    with opened(browser, path) as page:
        told = page.evaluate("report.records.told")
        said = page.evaluate("[report.records.period, TOLERANCE, report.records.found.periods]")
        rows = page.evaluate("Array.from(report.records.rows)")
    own = write_whole(load("valve-train"), tmp_path)
    here = Platform("x86_64-unknown-linux-gnu", "x86_64-linux-musl", "", "", "")
    sizes = list_sizes(find_factory(own)(), SAMPLES)
    host = tmp_path / "host"
    source = str(Path(__file__).with_name("cycle_host.c"))
    host.write_bytes(link_cycle(own, here, sizes, ["cycle.c", source], ["-mcpu=baseline", "-lm"]))
    host.chmod(0o700)
    given = np.concatenate([said, *(told[name] for name in LISTED)]).astype(np.float64)
    made = subprocess.run([host], input=given.tobytes(), capture_output=True, check=True).stdout
    np.testing.assert_array_equal(np.frombuffer(made).view(np.int64), np.array(rows).view(np.int64))


def test_what_has_events_or_no_prescribed_speed_is_refused(tmp_path):
    with pytest.raises(TranslationError, match="has events, which a page does not look for"):
        cycle_module("slider_crank", find_factory("slider_crank")(), SAMPLES)
    with pytest.raises(MistakeError, match="no flywheel prescribes the speed"):
        tribocosim.report("bouncing-mass", tmp_path / "cycle.html", cycle=True)
