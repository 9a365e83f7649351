"""What contacts go through in a run is accumulated at every macro step, whatever is recorded."""

import json
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from models.contact.ehl_contact import TABLE_3
from models.core import roles
from orchestrator.assessment.contacts import lines, list_details, name_estimates, summarise_rows
from orchestrator.assessment.contacts.accumulation import SEEN
from orchestrator.assessment.contacts.contact_summary import Accumulator
from orchestrator.assessment.contacts.lines import GROUPS
from orchestrator.assessment.trains import list_parts
from orchestrator.errors import CheckpointError
from orchestrator.run.checkpoint import fitting
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from orchestrator.store.json_codec import from_text, to_text

from .commands import IN_PROCESS, called

RECORDS = 200
told = partial(lines, fixed_steps=True)


def _run(*changes):
    """The system, and outputs of its contact at random inputs, a quarter of them without load."""
    system = build_system(load("valve-train", changes))
    instance = system.instances["contact"]
    component = instance.component
    random = np.random.default_rng(7)
    p = component.parameters.vector(instance.parameters)
    columns = {name: np.zeros(RECORDS) for name in system.outputs.names}
    drivers = {c.target.variable: str(c.source) for c in system.connections if c.target.instance == "contact"}
    columns["time"] = np.cumsum(random.uniform(1e-6, 1e-4, RECORDS))
    for i in range(RECORDS):
        inputs = {
            "approach": random.uniform(-5e-6, 15e-6),
            "entraining_velocity": random.uniform(-4.0, 4.0),
            "radius_of_curvature": random.uniform(0.005, 0.05),
        }
        y = np.zeros(component.outputs.size)
        x = np.array([random.uniform(0.1e-6, 2e-6)])
        component.flat_output(0.0, x, component.inputs.vector(inputs), p, y)
        for name, value in inputs.items():
            columns[drivers[name]][i] = value
        for name, value in component.outputs.named(y).items():
            columns[f"contact.{name}"][i] = value
    return system, columns


@pytest.fixture(scope="module")
def run():
    return _run()


def summaries(system, columns):
    return summarise_rows(system, columns.__getitem__)


def lasting(time, holds):
    """How long a condition holds, by the trapezoidal rule."""
    return float(np.sum(0.5 * np.diff(time) * (holds[1:].astype(float) + holds[:-1])))


@pytest.mark.parametrize(("rate", "feeds"), [(2e-3, True), (1e-5, False), (-2e-3, False)])
def test_a_film_that_grows_under_load_gives_its_work_to_the_motion(run, rate, feeds):
    """100 N on a film that grows at a rate: power is the product, a coefficient of friction it over the
    load and the entraining velocity (1 m/s)."""
    system, columns = run
    entrained = next(str(c.source) for c in system.connections if c.target.variable == "entraining_velocity")
    steady = {"contact.load": 100.0, "contact.squeeze_velocity": rate, entrained: 1.0}
    filled = {name: np.full(RECORDS, value) for name, value in steady.items()}
    found = summaries(system, columns | filled)
    summary = found["contact"]
    assert summary.film_power == pytest.approx(100.0 * rate)
    assert summary.film_feed == pytest.approx(np.sign(rate))
    assert summary.film_friction == pytest.approx(rate)
    assert any("film_model = 'dowson_toyoda'" in text for text in told(found)) == feeds


def test_shares_and_extremes_agree_with_the_flags_of_the_contact(run):
    """Groups are listed exactly if their flag fell under load, with share of time and extremes beyond it."""
    system, columns = run
    summary = summaries(system, columns)["contact"]
    found = summary.ranges
    time, loaded = columns["time"], columns["contact.load"] > 0.0
    assert 0.0 < np.mean(loaded) < 1.0
    for group, (low, high) in TABLE_3.items():
        outside = loaded & (columns[f"contact.{group}_in_range"] == 0.0)
        assert (group in found) == outside.any()
        if group in found:
            share = lasting(time, outside) / lasting(time, loaded)
            assert found[group].share == pytest.approx(share, rel=1e-12)
            assert found[group].least < low or found[group].most > high
    (said,) = [line for line in list_details({"contact": summary}, "rows") if "film formula" in line]
    (short,) = name_estimates({"contact": summary})
    assert len(short) < 0.6 * len(said)
    for group, one in found.items():
        sides = (one.least < one.low) + 2 * (one.most > one.high)
        assert f"{GROUPS[group][sides - 1]} in {100.0 * one.share:.1f}" in said
    assert ("shares overlap" in short) == (len(found) > 1)
    # U = eta |u| / (E R) with E = pi / compliance, for two equal steels pi E1 / (2 (1 - nu^2)).
    fastest = np.abs(columns["camshaft.entraining_velocity"]) / columns["camshaft.radius_of_curvature"]
    modulus = np.pi * 207e9 / (2.0 * (1.0 - 0.3**2))
    assert found["speed"].most == pytest.approx(0.036 * fastest[loaded].max() / modulus, rel=1e-12)


def test_extremes_are_those_of_the_columns(run):
    system, columns = run
    contact = summaries(system, columns)["contact"]
    time, load_ = columns["time"], columns["contact.load"]
    loaded = load_ > 0.0
    film = np.where(loaded, columns["contact.minimum_film_thickness"], np.inf)
    assert (contact.least_load, contact.largest_load) == (0.0, load_.max())
    assert contact.largest_load_time == time[load_.argmax()]
    assert contact.pressure == columns["contact.maximum_pressure"].max()
    assert (contact.film, contact.film_time) == (film.min(), time[film.argmin()])
    assert contact.lost == pytest.approx(1.0 - lasting(time, loaded) / (time[-1] - time[0]), rel=1e-12)
    assert contact.separation.count == np.sum(loaded[:-1] & ~loaded[1:]) + (not loaded[0])
    assert contact.separation.gap == -columns["contact.deflection"][~loaded].min()


def test_ranges_are_those_of_one_formula(run):
    _, columns = run
    other = build_system(load("valve-train", ["components.contact.parameters.film_model=dry"]))
    assert not summaries(other, columns)["contact"].ranges
    assert summaries(other, columns)["contact"].film == 0.0


def history(time, load_, gap=None, scenario="valve-train", lift=None):
    """The first contact with these loads, and gaps where there is none; pressure 1 MPa/N."""
    system = build_system(load(scenario))
    accumulator = Accumulator(system, list_parts(system, roles.Contact)[:1])
    for k, t in enumerate(time):
        row = {"load": load_[k], "maximum_pressure": 1e6 * max(load_[k], 0.0), "minimum_film_thickness": 1e-6,
               "film_ratio": 2.0, "deflection": -gap[k] if gap is not None else 0.0,
               "entraining_velocity": 1.0, "radius_of_curvature": 0.02,
               "cam_lift": lift[k] if lift is not None else 0.0}  # fmt: skip
        accumulator.seen[0] = [row.get(name, 0.0) for name in SEEN]
        accumulator.add(t)
    return accumulator.found()


def test_a_separation_is_told_with_its_gap_and_the_landing_after_it():
    """A body thrown up by v returns after 2 v/g with v, and lands in a half sine of load F and duration T,
    whose impulse is 2 F T / pi."""
    v, g, F, T, up = 1.0, 1000.0, 5000.0, 1e-4, 2e-3
    step = 1e-6
    time = np.arange(0.0, 4e-3, step)
    flying, landed = (time >= 1e-3) & (time < 1e-3 + up), (time >= 1e-3 + up) & (time < 1e-3 + up + T)
    s = time - 1e-3
    gap = np.where(flying, v * s - 0.5 * g * s**2, 0.0)
    load_ = np.where(flying, 0.0, 100.0)
    load_ = np.where(landed, F * np.sin(np.pi * (s - up) / T) + 1e-3, load_)
    contact = history(time, load_, gap)["contact"]
    assert contact.separation.count == 1
    assert contact.separation.longest == pytest.approx(up, abs=1.5 * step)
    assert contact.separation.longest_time == pytest.approx(1e-3, abs=1.5 * step)
    assert contact.separation.gap == pytest.approx(0.5 * v**2 / g, rel=1e-3)
    assert contact.separation.gap_time == pytest.approx(1e-3 + v / g, abs=3 * step)
    assert contact.lost == pytest.approx(up / time[-1], rel=1e-3)
    impact = contact.impact
    assert impact.load == pytest.approx(F, rel=1e-3)
    assert impact.speed == pytest.approx(v, rel=1e-2)
    assert impact.impulse == pytest.approx(2.0 * F * T / np.pi, rel=1e-2)
    assert impact.steps == pytest.approx(0.5 * T / step, abs=2)
    assert impact.resolved
    assert not any("not resolved" in line for line in told({"contact": contact}))


def test_a_contact_that_lash_opens_on_the_base_circle_is_not_lost():
    """A cam of 8.3 mm, lash 0.2 mm: up to a tenth of its lift the seat bears the valve. Open there in 62 % of
    the time, also on the ramps above the lash, and for one of ten seconds over the nose; without a seat, or
    where an adjuster has to keep contact, all of it is lost."""
    time, lift = np.arange(0.0, 10.005, 0.01), np.zeros(1001)
    lift[300:701] = 8.3e-3 * np.sin(np.linspace(0.0, np.pi, 401))
    rest, nose = lift <= 0.83e-3, (time >= 4.5) & (time < 5.5)
    pressed = np.where(rest, 0.0, 400.0 + 100.0 * np.cos(2.0 * np.pi * (time - 4.0)))
    gap = np.where(rest, 2e-4, np.where(nose, 3e-5, 0.0))
    thrown = np.where(nose, 0.0, pressed)
    lashed = history(time, thrown, gap, "seat-and-lash", lift)["contact"]
    assert lashed.at_rest == pytest.approx(np.mean(rest), abs=2e-3)
    assert lashed.lost == pytest.approx(0.1, abs=2e-3)
    assert (lashed.separation.count, lashed.separation.gap) == (1, 3e-5)
    assert lashed.separation.longest == pytest.approx(1.0, abs=0.02)
    said = " ".join(told({"contact": lashed}))
    assert "lost while the cam lifts, in 10 % of the whole run" in said
    assert f"open in {100.0 * lashed.at_rest:.3g} % of the whole run, on the base circle" in said
    assert lashed.on_ramps == pytest.approx(np.mean(rest & (lift > 2e-4)), abs=2e-3)
    assert (lashed.ramp_lift, lift[round(100.0 * lashed.ramp_time)]) == (lift[rest].max(),) * 2
    on_ramps = f"open in {100.0 * lashed.on_ramps:.3g} % of the whole run, on the ramps above the lash"
    assert f"{on_ramps}, up to a lift of {1e3 * lashed.ramp_lift:.3g} mm at t = " in said
    closed = history(time, np.where(lift > 2e-4, 9.0, 0.0), gap, "seat-and-lash", lift)["contact"]
    assert closed.at_rest > closed.on_ramps == 0.0
    for name in ("valve-train", "direct-acting-hla"):
        (whole,) = history(time, thrown, gap, name, lift).values()
        assert whole.lost == pytest.approx(lashed.lost + lashed.at_rest, rel=1e-12)
        assert (whole.at_rest, whole.on_ramps, whole.separation.gap) == (0.0, 0.0, 2e-4)
    far = history(time, 1e3 * thrown, 400.0 * gap, "seat-and-lash", lift)
    said = " ".join(told(far))
    assert "highest load 500000 N" in said
    assert "largest gap 12000 µm" in said
    low = history(time, pressed + 1.0, gap, "seat-and-lash")
    judged = (
        "contact: the cam stays on its base circle and ramps, where no least load is judged; highest load"
    )
    assert told(low)[0].startswith(judged)
    kept = history(time, pressed, gap, "seat-and-lash", lift)["contact"]
    assert (kept.lost, kept.separation) == (0.0, None)
    least = int(np.argmin(np.where(rest, np.inf, pressed)))
    assert (kept.least_load, kept.least_load_time) == (pressed[least], time[least])
    first = (
        f"kept while the cam lifts, least load 300 N at t = {time[least]:.6g} s; highest load 500 N at t = "
    )
    assert told({"contact": kept})[0].startswith(f"contact: {first}")


def test_a_landing_within_a_few_macro_steps_is_warned_of():
    contact = history([0.0, 1.0, 2.0, 3.0], [10.0, 0.0, 500.0, 20.0])["contact"]
    assert contact.impact.steps == 1
    assert any("not resolved" in line for line in told({"contact": contact}))
    assert not any("not resolved" in line for line in told({"contact": contact}, fixed_steps=False))


def test_a_separation_at_the_end_counts_and_a_load_of_rounding_is_none():
    contact = history([0.0, 1.0, 2.0, 4.0], [10.0, 10.0, 0.0, 0.0])["contact"]
    assert (contact.separation.longest, contact.separation.longest_time) == (2.0, 2.0)
    contact = history([0.0, 1.0, 2.0], [-2.22e-16, 5.0, 5.0])["contact"]
    assert (contact.least_load, contact.separation.count) == (0.0, 1)
    assert history([0.0, 1.0], [0.0, 0.0]) == {}  # a contact without load


def test_a_pressure_beyond_the_elastic_limit_is_warned_of():
    """Above the limit of 2.004 GPa for one of four seconds."""
    found = history([0.0, 1.0, 2.0, 3.0, 4.0], [1.0, 1.0, 3000.0, 1.0, 1.0])
    assert found["contact"].pressure == 3e9
    assert found["contact"].pressure_time == 2.0
    assert found["contact"].yielding == 0.25
    assert any("yield" in line and "3000 MPa" in line for line in told(found))
    below = history([0.0, 1.0], [1.0, 2000.0])
    assert not any("yield" in line for line in told(below))


def test_a_course_that_goes_on_from_a_checkpoint_is_the_same_to_the_last_bit(run):
    system, columns = run
    rows = np.column_stack([columns.get(f"contact.{name}", np.ones(RECORDS)) for name in SEEN])

    def add(accumulator, some):
        for k in some:
            accumulator.seen[0] = rows[k]
            accumulator.add(columns["time"][k])

    whole, first, second = (Accumulator(system, ["contact"]) for _ in range(3))
    add(whole, range(RECORDS))
    add(first, range(70))
    second.resume(from_text(to_text(first.state())))
    add(second, range(70, RECORDS))
    assert second.found() == whole.found()
    assert second.found() != first.found()
    other = first.state()
    del other["lost_since"]
    with pytest.raises(CheckpointError, match="does not fit this run"), fitting():
        second.resume(other)


def test_of_many_contacts_the_thinnest_films_are_told_and_warnings_of_all(run):
    system, columns = run
    contact = replace(summaries(system, columns)["contact"], separation=None, impact=None, ranges={})
    many = {f"contact{n}": replace(contact, film=1e-6 / (n + 1)) for n in range(7)}
    many["contact0"] = replace(many["contact0"], pressure=3e9)
    text = told(many)
    assert [line.split(":")[0] for line in text[:4]] == ["contact6", "contact5", "contact4", "contact3"]
    assert text[4].startswith("3 more contacts")
    assert text[-1].startswith("contact0: the pressure reaches")
    assert "lower the load" in text[-1]
    many["contact0"] = replace(many["contact0"], pressure=9e9)
    assert "no steel bears more than 4000 MPa: look for a slip in speed" in told(many)[-1]


LIMIT = "components.contact.parameters.elastic_limit='1 GPa'"
FAST = [
    *(f"--set=components.flywheel.parameters.{end}_speed=4000 rpm" for end in ("initial", "final")),
    "--set=stop_time=16 ms", f"--set={LIMIT}", "--set=reference.enabled=false", "--no-figures", *IN_PROCESS,
]  # fmt: skip


def test_contacts_and_warnings_do_not_depend_on_what_is_recorded(tmp_path):
    """The follower leaves its cam and lands; from rows of 100 us its largest load was a sixth of it."""
    found, warned = [], []
    for every in ("5 us", "100 us"):
        out = tmp_path / every.replace(" ", "")
        done = called("run", "valve-train", *FAST, f"--set=output_step={every}", "--out", str(out))
        summary = json.loads((out / "summary.json").read_text())
        assert summary["contacts_from"] == "all macro steps"
        found.append(summary["contacts"]["contact"])
        warned.append([line for line in done.stdout.splitlines() if line.startswith("contact:")])
    angles = [contact.pop("angles") for contact in found]
    assert found[0] == found[1]
    assert angles[1] == pytest.approx(angles[0], abs=1e-6)
    assert warned[0] == warned[1]
    assert any("yield" in line for line in warned[0])
    assert any("separation" in line and "cam" in line for line in warned[0])
