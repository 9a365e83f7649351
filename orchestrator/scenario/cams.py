"""The cam of a component's table: its profile, and the follower for which its lift is meant."""

from collections.abc import Mapping
from typing import Any, get_type_hints

from models.valve_train.cams.law import LAW
from models.valve_train.cams.table import TABLE
from models.valve_train.followers.shape import FOLLOWERS
from models.valve_train.worn_cam import CamKind

from .component_table import ComponentTable
from .values import to_numbers, to_value


def name_follower(values: Mapping[str, Any]) -> str:
    """The camshaft's is flat, the tappet names its own."""
    if "rolls" in values:
        return "finger_roller" if values["rolls"] else "finger_pad"
    return str(values.get("follower", "flat"))


def read_cam(table: ComponentTable) -> CamKind:
    """The cam of a component that has one."""
    layout = table.resolve().parameters
    numbers = {f.name: f.start for f in layout.fields} | to_numbers(layout, table.parameters)
    values = {f.name: to_value(f.quantity, numbers[f.name]) for f in layout.fields}
    kind = FOLLOWERS[name_follower(values)]
    own = {**numbers, "radius": numbers.get("follower_radius", 0.0)}
    geometry = kind.geometry(**{key: own[key] for key in get_type_hints(kind.geometry) if key in own})
    profile = TABLE if table.structure.get("table_points") else LAW
    return CamKind(profile, layout.view(layout.vector(numbers)), kind, geometry)
