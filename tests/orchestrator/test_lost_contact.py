"""Lost contact has one definition, which everything that speaks of it asks."""

import math

import numpy as np
import pytest
import xarray

from models.catalogue import CATALOGUE
from models.core.quantities import Quantity
from orchestrator.assessment.contacts import summarise_rows
from orchestrator.assessment.friction.cycle import Cycle
from orchestrator.assessment.lost_contact import AT_REST, LOADED, LOST, ON_RAMP, ContactLaw
from orchestrator.assessment.merits import read_motion
from orchestrator.assessment.motion import Part
from orchestrator.assessment.trains import check_lash, describe_floating, find_law, find_trains
from orchestrator.plots.data import FigureData
from orchestrator.report.packing import list_spans
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from orchestrator.study.speeds.separation import name_lost

# A lash of 0.2 mm, and a lobe above 0.8 mm.
LAW = ContactLaw(0.2e-3, 0.8e-3)
# A cam's lift (mm), row by row: base circle, ramp, lobe, ramp, base circle.
LIFT = (0.0, 0.2, 0.3, 0.7, 0.9, 4.0, 0.9, 0.7, 0.3, 0.2, 0.0)
NAMES = {LOADED: "l", AT_REST: "b", ON_RAMP: "r", LOST: "x"}


@pytest.mark.parametrize(
    ("loads", "found"),
    [
        ("01111111100", "bllllllllbb"),  # rounding on the base circle is no load
        ("00011111000", "bbrlllllrbb"),  # it rebounds as the lash is taken up, and as the valve is put down
        ("00111011100", "bblllxlllbb"),  # it flies over the nose
        ("00111000000", "bblllxxxxbb"),  # a flight from the lobe is lost on the ramp, down to the lash
        ("00111000100", "bblllxxxlbb"),  # or until load returns
        ("00100001100", "bblrxxxllbb"),  # a rebound on the ramp is lost from where it reaches the lobe
        ("00000000000", "bbrrxxxxxbb"),
    ],
)  # fmt: skip
def test_where_a_flight_has_been_says_what_a_contact_without_load_is(loads, found):
    weights = np.array([1e-10 if one == "0" else 300.0 for one in loads])
    said = "".join(NAMES[one] for one in LAW.judge(weights, 1e-3 * np.array(LIFT)))
    assert said == found
    bare = ContactLaw().judge(weights, 1e-3 * np.array(LIFT))
    np.testing.assert_array_equal(bare == LOST, weights < 1.0)  # no seat, or an adjuster


def test_a_flight_is_lost_again_from_its_next_lobe_only():
    """Lost over the nose, at rest on the base circle, on the next ramp as any other contact."""
    lift = np.array([4.0, 0.5, 0.0, 0.5, 4.0]) * 1e-3
    assert LAW.judge(np.zeros(5), lift).tolist() == [LOST, LOST, AT_REST, ON_RAMP, LOST]


@pytest.mark.parametrize(
    ("name", "changes", "lash"),
    [
        ("seat-and-lash", [], 0.2),
        ("finger-follower", [], 0.1),  # the lift of its profile is the valve's
        ("pushrod-train", [], 0.24),  # 0.3 mm times 32/40, both arms level
        # asin(0.3/40 - sin 20 deg) + 20 deg = 7.970 mrad; 32 (sin(7.970 mrad - 10 deg) + sin 10 deg)
        ("pushrod-train", ["rod_angle='10 deg'", "valve_angle='20 deg'"], 0.25133),
        # 0.3 x 32 cos 10 deg / (40 cos 20 deg)
        ("pushrod-train", ["rod_angle='10 deg'", "valve_angle='20 deg'", "small_motion=true"], 0.25152),
    ],
)  # fmt: skip
def test_the_cam_takes_up_the_lash_at_the_valve_by_the_ratio_of_the_train(name, changes, lash):
    system = build_system(load(name, [f"components.rocker.parameters.{change}" for change in changes]))
    (train,) = find_trains(system)
    assert 1e3 * train.lash == pytest.approx(lash, abs=6e-6)
    assert train.contact_law == (train.lash, train.lobe)


def test_parts_that_float_within_a_lash_are_named_with_their_remedy():
    """A train with weight, or an adjuster, has none; nor has a stem, which is beyond the lash."""
    weights = [f"components.{part}.parameters.gravity" for part in ("tappet", "pushrod")]
    (said,) = describe_floating(build_system(load("pushrod-train")))
    assert all(word in said for word in ("tappet and pushrod", *weights))
    known = (
        ("pushrod-train", weights),
        ("qin2000-train", []),
        ("seat-and-lash", []),
        ("valve-stem", []),
        ("direct-acting-hla", []),
    )
    for name, given in known:
        assert describe_floating(build_system(load(name, [f"{path}=9.81 m/s2" for path in given]))) == []


@pytest.mark.parametrize(("lash", "lift"), [("1.2 mm", 0.96e-3), ("60 mm", 32e-3)])
def test_a_lash_above_a_tenth_of_the_lift_moves_the_lobe_by_the_cams_share_of_it(lash, lift):
    """1.2 mm at the valve are 0.96 mm of the tappet, whose cam lifts by 7.35 mm; 60 mm no rocker takes up."""
    system = build_system(load("pushrod-train", [f"components.valve_spring.parameters.lash='{lash}'"]))
    assert find_law(system, "cam_contact") == pytest.approx((lift, lift))


@pytest.mark.parametrize("angles", [(0.0, 0.0), (0.3, -0.2)])
@pytest.mark.parametrize("small", [0.0, 1.0])
def test_a_rockers_ends_move_together(angles, small):
    """`find_rod_position` of what the component puts out."""
    rocker = CATALOGUE["rocker"]()
    given = {"rod_angle": angles[0], "valve_angle": angles[1], "small_motion": small}
    y = np.zeros(rocker.outputs.size)
    p = rocker.parameters.vector(given)
    for rotation in (-0.1, 0.0, 0.2):
        x = rocker.state.vector({"rotation": rotation})
        rocker.flat_output(0.0, x, np.zeros(rocker.inputs.size), p, y)
        found = rocker.outputs.named(y)
        rod = rocker.roles[0].find_rod_position(found["tip_position"], rocker.parameters.named(p))
        assert rod == pytest.approx(found["rod_position"], abs=1e-15)


def test_texts_figures_pages_and_cycles_have_one_definition():
    """Random loads over two turns of a cam with lash, seen by all that tell of them."""
    system = build_system(load("seat-and-lash"))
    random, time = np.random.default_rng(3), np.linspace(0.0, 1.0, 2001)
    lift = 8.3e-3 * np.maximum(0.0, np.sin(4.0 * np.pi * time))
    force = np.repeat(random.choice([0.0, 400.0], 667), 3)
    columns = {name: np.zeros(time.size) for name in system.outputs.names}
    columns["camshaft.radius_of_curvature"] += 0.02
    columns |= {"time": time, "camshaft.cam_lift": lift, "contact.load": force}
    law = find_law(system, "contact")
    states = law.judge(force, lift)
    lost = states == LOST
    assert set(states) == {LOADED, AT_REST, ON_RAMP, LOST}
    np.testing.assert_array_equal(Part(read_motion(system, columns.__getitem__), "contact").lost, lost)
    quantities = dict.fromkeys(columns, Quantity("1"))
    data = FigureData("", time, columns, time[:0], {}, quantities, system=system)
    np.testing.assert_array_equal(data.lost("contact"), lost)
    values = {"load": force, "cam_lift": lift}
    np.testing.assert_array_equal(Cycle("contact", time, values, law).lost, lost)
    found = summarise_rows(system, columns.__getitem__)["contact"]
    for share, rows in ((found.lost, lost), (found.on_ramps, states == ON_RAMP)):
        assert share == pytest.approx(np.trapezoid(rows.astype(float), time), rel=1e-12)
    spans = np.zeros(time.size, bool)
    for begin, end in list_spans(lost):
        spans[begin:end] = True
    np.testing.assert_array_equal(spans, lost)
    assert list_spans(np.array([0, 0, 1, 0, 0, 0, 0, 1], bool), 3) == [[0, 1], [2, 3]]
    assert math.isinf(find_law(build_system(load("direct-acting-hla")), "cam_contact").lobe)


def test_a_lash_that_leaves_some_lift_is_taken():
    """9 mm at the valve are 7.2 mm at the rod's end of the rocker, of a cam that lifts by 7.35 mm."""
    check_lash(build_system(load("pushrod-train", ["components.valve_spring.parameters.lash=9 mm"])))


def test_the_contact_that_is_lost_is_named_where_there_are_several():
    at = xarray.Dataset({"cam_contact.lost": 0.0, "tip.lost": 0.2, "tip.lost_on_nose": 0.1})
    assert (name_lost(at), name_lost(at[["tip.lost"]])) == (" in tip", "")
