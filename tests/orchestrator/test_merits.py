"""What a run says first of its trains, from columns whose answers are known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pytest

from models.core.quantities import Vector
from orchestrator.assessment.contacts import ContactSummary, lines
from orchestrator.assessment.merits import list_merits
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system

# A turn of the cam in 0.06 s: 8 mm of lift about the nose, half a sine over 120 deg.
ANGLE = np.linspace(0.0, 2.0 * np.pi, 7201)
LIFT = 8e-3 * np.maximum(0.0, np.cos(1.5 * (ANGLE - np.pi))) * (np.abs(ANGLE - np.pi) < np.pi / 3.0)
CLOSED = np.flatnonzero(LIFT > 1e-9)[-1] + 1


def told(**changed: Vector) -> str:
    """The line of a train whose columns are these, and else 0."""
    columns = {
        "time": 0.06 * ANGLE / (2.0 * np.pi),
        "camshaft.profile_angle": ANGLE,
        "camshaft.cam_lift": LIFT,
        "contact.load": 300.0 + 0.0 * ANGLE,
        "spring.force": np.where(LIFT > 4e-3, 400.0, 310.0),
        "valve.seat_dip": np.where(LIFT > 1e-9, -LIFT, 1e-6),
        "valve.velocity": np.where(np.arange(ANGLE.size) == CLOSED, -0.25, 0.0),
        "spring.least_gap": 1e-3 - 0.1 * LIFT,
        "contact.maximum_pressure": 5e8 * LIFT / 8e-3,
        "contact.film_ratio": 0.5 + 0.0 * ANGLE,
        "contact.friction_force": 12.0 + 0.0 * ANGLE,
        "camshaft.sliding_velocity": 2.0 + 0.0 * ANGLE,
    } | {name.replace("__", "."): values for name, values in changed.items()}

    def read(names: Sequence[str]) -> Mapping[str, Vector]:
        return {name: columns.get(name, 0.0 * ANGLE) for name in names}

    (line,) = list_merits(build_system(load("coil-clash")), read)
    return line


def test_a_run_says_first_whether_its_valve_follows_lands_and_what_it_bears() -> None:
    assert told() == (
        "valve: separation margin 75 % (least load on the open valve over its spring's force); "
        "seats with 0.25 m/s; does not bounce; no clash of coils, least gap 0.2 mm; "
        "highest pressure 500 MPa in contact; least film ratio 0.5 in contact; friction 24 W"
    )


HOP = np.zeros(ANGLE.size)
HOP[CLOSED + 100 : CLOSED + 200] = 30e-6


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"contact__load": 9.0 * (abs(ANGLE - np.pi) > np.pi / 60.0)}, "contact is lost for 5.3 %"),
        ({"valve__seat_dip": np.where(LIFT > 1e-9, -LIFT, 1e-6) - HOP}, "bounces by 29 µm"),
        ({"spring__clash_force": 45.0 * LIFT / 8e-3}, "coils of spring clash with up to 45 N"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_train_is_named(changed: dict[str, Vector], said: str) -> None:
    """The cam lifts by more than a tenth over 2 acos(0.1)/1.5 = 112.35 deg, of which 6 deg are 5.34 %."""
    assert said in told(**changed)


@pytest.mark.parametrize(
    ("film", "said"), [(2e-10, "; no film at t = 3 s"), (1e-9, "; least film 0.001 µm at t = 3 s")]
)
def test_a_film_below_an_atom_is_none(film: float, said: str) -> None:
    summary = ContactSummary(1.0, 2.0, 1.0, 0.0, 1e8, 2.0, 1e9, 0.0, film, 3.0, 0.01, 1e-5)
    assert said in lines({"contact": summary}, "rows", True)[0]
