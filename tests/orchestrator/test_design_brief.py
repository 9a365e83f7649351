"""Briefs of `design`: what they ask for, what is refused, and the shipped and printed ones."""

import math
import re
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

from models.core.system import ModelError
from orchestrator.errors import MistakeError
from orchestrator.scenario.files import load
from orchestrator.study.design.brief import Brief, Limits, list_briefs, read_bounds, read_brief
from orchestrator.study.design.figures import Bound, Objective, find_objective, list_bounds
from orchestrator.study.design.train import open_train
from orchestrator.study.design.wires import list_wires
from orchestrator.study.speeds.subject import describe_numbers

from .commands import ROOT
from .test_design import write_brief
from .test_design_figures import WIRE


def test_asked_ramps_are_those_of_the_cam(tmp_path: Path) -> None:
    brief = '[ramps]\nheight = "0.3 mm"\nvelocity = "0.01 mm/deg"'
    asked = read_brief(str(write_brief(tmp_path, f'scenario = "pushrod-train"\n{brief}')))
    train = open_train(asked.tables, 24, ramps=asked.brief.ramps)
    begin = train.lobe.begin
    lifts = [train.lobe.kind.lift(begin - math.radians(a)) for a in (6.0, 10.0)]
    assert [one.ds for one in lifts] == pytest.approx([1e-5 / math.radians(1.0)] * 2, rel=1e-9)
    # Half of the blend into the event is left of the ramp at its foot.
    assert train.lobe.ramp(0.5 * (begin + train.lobe.end)).s == pytest.approx(3e-4, rel=1e-9)
    fast = read_brief(str(write_brief(tmp_path, f'scenario = "pushrod-train"\n{brief.replace("0.01", "1")}')))
    with pytest.raises(MistakeError, match=r"ramps\.velocity = 1 mm/deg: must be at most"):
        open_train(fast.tables, 24, ramps=fast.brief.ramps)


def read(text: str) -> Brief:
    return Brief.model_validate({"scenario": "valve-train", **tomllib.loads(text)})


KNOWN = describe_numbers(load("valve-train"))


def test_figures_and_objectives_are_those_of_the_brief() -> None:
    own: Callable[[str, float], float] = lambda name, _: 2.0  # noqa: E731
    brief = read('[limits]\nleast_spring_margin = 0.3\n[figures]\n"contact.largest_load" = {most = "900 N"}\n'
                 '"contact.friction_power" = {most = "own"}')  # fmt: skip
    assert list(list_bounds(brief, KNOWN, own)) == [
        Bound("valve_spring.seating_velocity", 1.0, 2.0),
        Bound("valve_spring.bounce", 1.0, 2.0),
        Bound("valve_spring.spring_margin", -1.0, 0.3),
        Bound("contact.largest_load", 1.0, 900.0),
        Bound("contact.friction_power", 1.0, 2.0),
    ]
    wanted = find_objective(read('minimise = "flywheel.mean_torque"'), KNOWN, own, [1.0, 3.0])
    assert wanted.weigh({1.0: 1.9, 3.0: 2.0}) == pytest.approx(1.025)
    assert find_objective(read(""), KNOWN, own, [1.0]) == Objective()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('maximise = "contact.friction_powr"', "did you mean contact.friction_power"),
        ('minimise = "lift_area"', "is to be maximised"),
        ('[figures]\n"contact.bounce" = {most = "1 mm"}', "figures.contact.bounce"),
        ('[figures]\n"contact.largest_load" = {most = 900}', "write the number with its unit"),
        ('[limits]\nleast_clearance = "1 mm"', "no part of the scenario has the figure least_clearance"),
        ('maximise = "separation_speed"\n[limits]\nseparation_speed = "free"', "needs limits.separation"),
    ],
)
def test_wishes_that_a_train_cannot_meet_are_refused(text: str, words: str) -> None:
    brief = read(text)

    def ask() -> None:
        list(list_bounds(brief, KNOWN, lambda name, side: 1.0))
        find_objective(brief, KNOWN, lambda name, speed: 1.0, [1.0])

    with pytest.raises(MistakeError, match=words):
        ask()


def test_a_seat_keeps_its_landing_unless_the_brief_frees_it() -> None:
    """Where there is a seat; a limit that is asked for needs one."""

    def none(name: str, side: float) -> float:
        raise ModelError("no value in the cycle")

    free = '[limits]\nlargest_bounce = "free"\nlargest_seating_velocity = '
    (own,) = list_bounds(read(f'{free}"0.3 m/s"'), KNOWN, none)
    assert own == Bound("valve_spring.seating_velocity", 1.0, 0.3)
    assert not list(list_bounds(read(f'{free}"free"'), KNOWN, none))
    assert not list(list_bounds(read(""), KNOWN, none))
    with pytest.raises(ModelError):
        list(list_bounds(read(f'{free}"own"'), KNOWN, none))
    assert not list(list_bounds(read(""), {}, none))


def test_wires_have_bounds_with_units(tmp_path: Path) -> None:
    tables = {"components": {"spring": WIRE}}
    brief = read('[parameters]\n"spring.wire.diameter" = ["3.8 mm", "4.2 mm"]')
    bounds = read_bounds(brief, load("valve-train"), "flywheel", dict(list_wires(tables)))
    assert bounds == {"spring.wire.diameter": pytest.approx((3.8e-3, 4.2e-3))}


PAGE = (ROOT / "docs" / "how-to" / "design-a-cam.md").read_text("utf-8")


@pytest.mark.parametrize("brief", [*list_briefs(), *re.findall(r"```toml\n(.+?)```", PAGE, re.DOTALL)])
def test_shipped_and_printed_briefs_are_read(tmp_path: Path, brief: str) -> None:
    asked = read_brief(brief if brief in list_briefs() else str(write_brief(tmp_path, brief)))
    scenario = open_train(asked.tables, asked.brief.coefficients, asked.brief.cam, asked.brief.event).scenario
    assert set(read_bounds(asked.brief, scenario, "flywheel")) == set(asked.brief.parameters)
    assert asked.brief.limits.separation_speed == "own"


def test_every_limit_is_in_the_documents() -> None:
    assert [name for name in Limits.model_fields if f"`{name}`" not in PAGE] == []
