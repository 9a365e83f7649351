"""The kinds of terminals that several components have, with the names of their members."""

from .fmi.terminals import Terminal


def translation(
    description: str, position: str = "position", velocity: str = "velocity", force: str = "force"
) -> Terminal:
    """A body's motion along a line, and the force on it."""
    members = {"position": position, "velocity": velocity, "force": force}
    return Terminal("translation", description, members)


def rotation(prefix: str, **more: str) -> Terminal:
    """What a shaft turns: its motion and torque, whose names begin with `prefix`, and `more` members."""
    members = {name: f"{prefix}_{name}" for name in ("angle", "speed", "acceleration", "torque")}
    return Terminal("rotation", "turned by a shaft", members | more)


def film_contact(
    description: str, position: str, velocity: str, load: str, friction: str, prefix: str = "",
    radius: str = "radius_of_curvature",
) -> Terminal:  # fmt: skip
    """A lubricated contact: the approach of its surfaces, their velocities (`prefix`) and forces."""
    members = {
        "position": position,
        "velocity": velocity,
        "entraining_velocity": f"{prefix}entraining_velocity",
        "sliding_velocity": f"{prefix}sliding_velocity",
        "radius_of_curvature": radius,
        "load": load,
        "friction_force": friction,
    }
    return Terminal("film_contact", description, members)


def cam_on_shaft(description: str, each: str = "") -> Terminal:
    """A cam and its axis; `each` ends the names of a component that has several."""
    members = {name: f"cam_{name}{each}" for name in ("angle", "speed", "torque")}
    members |= {name: f"axis_{name}{each}" for name in ("x", "y", "velocity_x", "velocity_y")}
    members |= {name: f"cam_{name}{each}" for name in ("force_x", "force_y")}
    return Terminal("cam_on_shaft", description, members, partial=True)


def pivot_friction(description: str, speed: str, load: str, torque: str) -> Terminal:
    """A pin in its bearing."""
    return Terminal("pivot_friction", description, {"speed": speed, "load": load, "torque": torque})


# The pad of a lever on the valve.
TIP = film_contact(
    "film between the lever's pad and the valve",
    "tip_position", "tip_velocity", "tip_load", "tip_friction", "tip_", "tip_contact_radius",
)  # fmt: skip
# The film under a follower, and the cam on the shaft that drives it.
CAM = film_contact("film between cam and follower", "overlap", "overlap_rate", "cam_load", "cam_friction")
CAM_DRIVE = cam_on_shaft("turned by a shaft")
CRANK = rotation("crank", impulse="crank_impact_impulse")
CYLINDER_PRESSURE = Terminal("gas", "pressure on the piston", {"pressure": "gas_pressure"})
GAS_ON_HEAD = Terminal("gas_force", "gas on the head", {"force": "gas_force"})
