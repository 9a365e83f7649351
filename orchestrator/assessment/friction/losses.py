"""Parts that lose power to friction, and whether the motion contains it: by roles and connections."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

from models.core import roles
from models.core.system import Connection, Port, System

from ..trains import find_cams, list_parts

POWER, ROLLING_POWER = "friction_power", "rolling_power"
CONTACT, ROLLING, SLIP, TIP = "cam contact", "rolling", "roller slip", "valve tip"
PIN, PIVOT, BORE, GUIDE = "roller pin", "lever pivot", "tappet bore", "valve guide"
BEARING, WALL = "camshaft bearing", "cylinder wall"
SHARES = (CONTACT, ROLLING, SLIP, PIN, PIVOT, TIP, BORE, GUIDE, BEARING, WALL)
# The share of a joint or guide by the role of the part on which it acts; of none of these it is a bearing.
JOINTS: Mapping[type[roles.Role], str] = {
    roles.Roller: PIN,
    roles.PivotedFollower: PIVOT,
    roles.Rocker: PIVOT,
    roles.TranslatingFollower: BORE,
    roles.Valve: GUIDE,
}
# Of so many parts of a share the names are said.
NAMED = 3


@dataclass(frozen=True)
class Loss:
    """A part that loses power to friction: its figure and its share. `acts`: connections take the friction to
    the motion and on to the drive, whose torque contains it."""

    part: str
    share: str
    acts: bool = True
    figure: str = POWER


@lru_cache(maxsize=8)  # asked for by each number
def list_losses(system: System) -> tuple[Loss, ...]:
    """All losses to friction, in the order of their shares."""
    found = [loss for name in system.instances for loss in _find_losses(system, name)]
    return tuple(sorted(found, key=lambda loss: SHARES.index(loss.share)))


def name_outside(losses: Iterable[Loss]) -> str:
    """What of these the motion does not contain, e.g. "rolling (cam_contact)"; empty where it has all."""
    parts: dict[str, list[str]] = {}
    for loss in losses:
        if not loss.acts:
            parts.setdefault(loss.share, []).append(loss.part)
    several = {share: ", ".join(p) if len(p) <= NAMED else f"{len(p)} parts" for share, p in parts.items()}
    return ", ".join(f"{share} ({names})" for share, names in several.items())


def remark_outside(system: System) -> Iterator[str]:
    """A sentence to stand beside torques and friction; none where the motion has all friction."""
    if outside := name_outside(list_losses(system)):
        said = f"friction outside the motion: {outside}; no connection takes it there"
        drives = list_parts(system, roles.Drive)
        yield f"{said}, and the drive's torque and power do not contain it" if drives else said


def note_friction(system: System, part: str, figure: str) -> str:
    """What stands beside a figure of merit: of friction whether the motion contains it, of a torque of the
    drive what it leaves out."""
    losses, component = list_losses(system), system.instances[part].component
    if figure in (POWER, ROLLING_POWER, "friction_torque"):
        wanted = POWER if figure == "friction_torque" else figure
        own = next((loss for loss in losses if (loss.part, loss.figure) == (part, wanted)), None)
        if own is None:
            whose = "no cam rolls here" if figure == ROLLING_POWER else "another part has the friction"
            return f"not counted: {whose}"
        return "in the motion" if own.acts else "outside the motion"
    if losses and component.has_role(roles.Drive) and figure.endswith("_torque"):
        return describe_content(name_outside(losses))
    return ""


def describe_content(outside: str) -> str:
    """Of a torque of cam or drive, by what `name_outside` names."""
    return f"without the friction of {outside}" if outside else "with all friction"


def _find_losses(system: System, name: str) -> Iterator[Loss]:
    for role in system.instances[name].component.roles:
        if not isinstance(role, roles.Losing) or _is_replaced(system, name, role):
            continue
        rolling = isinstance(role, roles.RollingContact)
        share = ROLLING if rolling else _name_share(system, name, role)
        yield Loss(name, share, _acts(system, name, role.friction), ROLLING_POWER if rolling else POWER)


def _is_replaced(system: System, name: str, role: roles.Losing) -> bool:
    """A contact whose load another part's friction takes has none of its own; only one under a cam rolls."""
    if isinstance(role, roles.RollingContact):
        return _name_place(system, name) != CONTACT
    takers = (
        c.target for c in _list_outward(system, name) if c.source.variable == c.target.variable == "load"
    )
    surfaces = (system.instances[port.instance].component.has_role(roles.Surface) for port in takers)
    return isinstance(role, roles.Contact) and any(surfaces)


def _name_share(system: System, name: str, role: roles.Losing) -> str:
    if isinstance(role, roles.Roller):
        return SLIP
    if isinstance(role, roles.Contact | roles.Surface):
        return _name_place(system, name)
    takers = [connection.target.instance for connection in _list_outward(system, name)]
    givers = [c.source.instance for c in system.connections if c.target.instance == name]
    for beside in (*takers, *givers):
        for joined, share in JOINTS.items():
            if system.instances[beside].component.has_role(joined):
                return share
    return BEARING


def _name_place(system: System, name: str) -> str:
    """Under a cam, on the wall of a liner, or of a lever on its valve."""
    takers = (system.instances[c.target.instance].component for c in _list_outward(system, name))
    if any(taker.has_role(roles.Crank, roles.PistonCrank) for taker in takers):
        return WALL
    return CONTACT if name in find_cams(system, "sliding_velocity", "rolling_velocity") else TIP


def _list_outward(system: System, name: str) -> list[Connection]:
    return [connection for connection in system.connections if connection.source.instance == name]


def _acts(system: System, name: str, friction: str) -> bool:
    """Whether all parts beside it that have an input for this friction take it, and feel it."""
    outward = _list_outward(system, name)
    takers = [c.target for c in outward if c.source.variable == friction and _feels(system, c.target)]
    able = (p for c in outward if friction in system.instances[p := c.target.instance].component.inputs)
    return bool(takers) and {port.instance for port in takers}.issuperset(able)


def _feels(system: System, port: Port) -> bool:
    """Whether an input is a force with a power, or of a part whose powers are unknown, and connections lead
    on to the drive. A spin hands the friction on."""
    component = system.instances[port.instance].component
    if component.has_role(roles.Spin):
        return _acts(system, port.instance, roles.Spin.friction)
    has_power = not component.bonds or port.variable in (bond.effort for bond in component.bonds)
    return has_power and port.instance in _list_driven(system)


@lru_cache(maxsize=8)
def _list_driven(system: System) -> set[str]:
    """The parts from which connections lead to a drive; all without any drive."""
    found = set(list_parts(system, roles.Drive))
    if not found:
        return set(system.instances)
    while more := {c.source.instance for c in system.connections if c.target.instance in found} - found:
        found |= more
    return found
