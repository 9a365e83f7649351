"""The cam profile of a component by its structure, and the record of its parameters."""

from ...core.quantities import join
from .law import LAW
from .profile import CamProfile
from .table import TABLE, check_table


def choose_profile(table_points: int, own: type) -> tuple[CamProfile, type]:
    """A law, or with `table_points` a table of so many; its parameters follow the component's own."""
    check_table(table_points)
    profile = TABLE if table_points else LAW
    return profile, join(own, profile.parameters)
