"""The tables of a mechanism from its bodies, joints and force elements."""

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np

from ..contact.ehl_contact import ContactParameters
from ..core.quantities import Layout
from ..valve_train.cams.profile import CamProfile
from .bodies import Body, Point
from .forces import ContactSpring, ElasticField, LubricatedCam, SpringDamper
from .joints import Joint
from .tables import FIELD, PRESS, ROW, SPRING, Tables

Force = SpringDamper | ElasticField | LubricatedCam | ContactSpring
Find = Callable[[str], int]
F = TypeVar("F", bound=Force)


def fill_tables(
    bodies: Sequence[Body],
    joints: Sequence[Joint],
    forces: Sequence[Force],
    gravity: Point,
    profile: CamProfile,
    find: Find,
) -> Tables:
    """Bodies have the numbers that `find` gives for their names."""
    lubricated = _select(forces, LubricatedCam)
    pressed = _select(forces, ContactSpring)
    touching = [force.contact for force in lubricated] + [force.contact for force in pressed]
    cams = [joint.cam for joint in (*joints, *touching) if joint.cam is not None]
    held = sum(joint.cam is not None for joint in joints)
    unused_cam = Layout(profile.parameters, {"table_points": 0}).defaults()
    return Tables(
        mass=np.array([body.mass for body in bodies], float),
        inertia=np.array([body.inertia for body in bodies], float).reshape(-1, 3),
        moment=np.array([body.moment for body in bodies], float).reshape(-1, 3),
        gravity=np.array(gravity, float),
        rows=_list_rows(joints, find, 0),
        springs=_list_elements(_select(forces, SpringDamper), SPRING, find),
        fields=_list_elements(_select(forces, ElasticField), FIELD, find),
        touches=_list_rows(touching, find, held),
        lubricants=_stack([f.lubricant for f in lubricated], Layout(ContactParameters).defaults()),
        presses=_make_records(
            [{name: getattr(f, name) for name in ("stiffness", "damping", "bonded")} for f in pressed], PRESS
        ),
        cams=_stack([_select_profile(cam, unused_cam.dtype.names) for cam in cams], unused_cam),
    )


def _select(forces: Sequence[Force], kind: type[F]) -> list[F]:
    return [force for force in forces if isinstance(force, kind)]


def _list_rows(joints: Sequence[Joint], find: Find, cam: int) -> Any:
    """Rows of the joints' constraints; their cams have the numbers from `cam` on."""
    found = []
    for joint in joints:
        ends = {"i": find(joint.i), "j": find(joint.j), "cam": cam}
        found += [{**ends, **constraint.fields} for constraint in joint.constraints]
        cam += joint.cam is not None
    return _make_records(found, ROW)


def _list_elements(elements: Sequence[SpringDamper | ElasticField], dtype: Any, find: Find) -> Any:
    """Springs or fields in a table of that type."""
    return _make_records(
        [
            {name: getattr(s, name) for name in dtype.names} | {"i": find(s.i), "j": find(s.j)}
            for s in elements
        ],
        dtype,
    )


def _make_records(found: Sequence[dict[str, Any]], dtype: Any) -> Any:
    records = np.zeros(len(found), dtype)
    for record, fields in zip(records, found, strict=True):
        for name, value in fields.items():
            record[name] = value
    return records.view(np.recarray)


def _select_profile(cam: Any, names: Sequence[str]) -> Any:
    """The profile's own parameters of a component's record, so that kernels see one type of record."""
    record = np.zeros(1, np.dtype((np.record, [(name, cam.dtype[name]) for name in names])))[0]
    for name in names:
        record[name] = cam[name]
    return record


def _stack(records: Sequence[Any], unused: Any) -> Any:
    """Records side by side; one that is not used where there are none."""
    given = records or [unused]
    stacked = np.zeros(len(given), given[0].dtype)
    for i, record in enumerate(given):
        stacked[i] = record
    return stacked.view(np.recarray)
