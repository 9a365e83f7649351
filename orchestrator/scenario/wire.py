"""The wire of a spring in a scenario, which becomes the parameters of `valve_spring` or `coil_spring`."""

from dataclasses import replace
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field, ValidationError

from models.plausible import WIRE
from models.valve_train.shared import CLOSED_COILS
from models.valve_train.wire_materials import MATERIALS, MPA, PEENED, UNPEENED
from models.valve_train.wire_spring import WireSpring

from .fields import Table, in_unit
from .messages import join_keys, place_faults
from .values import Faults, Inserted, WithUnit, build_component

Length = Annotated[float, in_unit("m")]
Stress = Annotated[float, in_unit("Pa")]
# Along the active coils, from the fixed to the moving end.
Lengths = Annotated[
    list[Length],
    BeforeValidator(lambda value: value if isinstance(value, list) else [value]),
    Field(min_length=1),
]
# Parameters that the wire gives.
FOUND = (
    *("spring_rate", "surge_frequency", "preload", "clash_clearance", "gap"),
    *("wire_stress", "wire_amplitude", "wire_strength"),
)


class Wire(Table):
    """Wire, coils and lengths of a helical compression spring with closed ends."""

    diameter: Length = Field(description="Diameter of the wire (m)")
    mean_diameter: Lengths = Field(
        description="Mean diameter of the coils (m), or several at equal distances along the active coils, "
        "from the fixed to the moving end"
    )
    active_coils: Annotated[float, in_unit("1")] = Field(description="Number of coils that bend")
    end_coils: Annotated[float, in_unit("1", zero=True)] = Field(
        2.0, description="Closed coils of both ends together"
    )
    pitch: Lengths | None = Field(
        None, description="Pitch (m), or several as the mean diameters; left out: even, by the free length"
    )
    free_length: Length | None = Field(None, description="Length without load (m); left out: by the pitch")
    installed_length: Length = Field(description="Length while the valve is closed (m)")
    material: Literal["chrome-silicon", "chrome-vanadium", "oil-tempered", "music-wire"] = Field(
        "chrome-silicon", description="Wire, which gives moduli and strength"
    )
    peened: bool = Field(True, description="Whether the wire is shot-peened", strict=True)
    shear_modulus: Stress | None = Field(None, description="Instead of the material's (Pa)")
    tensile_strength: Stress | None = Field(
        None, description="Instead of the material's at this diameter (Pa)"
    )
    endless_amplitude: Stress | None = Field(
        None,
        description="Amplitude of shear stress borne without end at endless_mean (Pa); left out: Zimmerli's",
    )
    endless_mean: Stress | None = Field(None, description="Mean shear stress to endless_amplitude (Pa)")
    stress_factor: Literal["bergstraesser", "wahl"] = Field(
        "bergstraesser", description="Factor of the coil's curvature"
    )

    def build(self) -> WireSpring:
        """The spring. Faults if it cannot be wound."""
        if not WIRE.holds(self.diameter):
            raise Faults(("diameter", f" = {self.diameter:g} m: {WIRE.reason}; write the unit, e.g. '4 mm'"))
        material = MATERIALS[self.material]
        strength, modulus = self.tensile_strength, self.shear_modulus or material.shear_modulus
        endless = PEENED if self.peened else UNPEENED
        if (self.endless_amplitude is None) != (self.endless_mean is None):
            raise Faults(("", ": needs endless_amplitude and endless_mean together, or neither"))
        if self.endless_amplitude and self.endless_mean:
            endless = self.endless_amplitude, self.endless_mean
        material = replace(material, shear_modulus=modulus, endless=endless)
        if strength is not None:
            material = replace(material, strength=strength, exponent=0.0)
        if (free := self.free_length or 0.0) == 0.0 and not self.pitch:
            raise Faults(("", ": needs pitch or free_length"))
        try:
            return WireSpring(
                self.diameter,
                np.array(self.mean_diameter),
                np.array(self.pitch or [(free - self.end_coils * self.diameter) / self.active_coils]),
                self.active_coils,
                self.end_coils,
                material,
                self.stress_factor,
            )
        except ValueError as error:
            raise Faults(("", f": {error}")) from None

    def install(self) -> tuple[WireSpring, float]:
        """The spring, and its force while the valve is closed. Faults if it does not fit."""
        if self.pitch and self.free_length is not None:
            raise Faults(("free_length", ": follows from the pitch; leave one of them out"))
        spring = self.build()
        try:
            force = spring.find_force(spring.free_length - self.installed_length)
            spring.fatigue  # noqa: B018  # checks the strength
        except ValueError as error:
            place = "installed_length" if "compresses" in str(error) else "tensile_strength"
            raise Faults((place, f": {error}")) from None
        return spring, force


def read_wire(written: Any) -> Wire:
    """Checked. Faults, below `wire`."""
    try:
        return Wire.model_validate(written)
    except ValidationError as error:
        raise place_faults("wire", error, list(Wire.model_fields)) from None


def insert_wire(table: dict[str, Any]) -> Inserted:
    """Rate, surge, preload, gaps and strength by the table's `wire`, and a stiffness of closed coils if none
    is given."""
    given = table.get("parameters", {})
    for name in given:
        if name.partition("[")[0] in FOUND:
            raise Faults((f"parameters.{name}", ": follows from the wire; leave one of them out"))
    wire = read_wire(table["wire"])
    try:
        spring, force = wire.install()
    except Faults as error:
        raise Faults(*(replace(one, place=join_keys("wire", one.place)) for one in error.faults)) from None
    component = build_component(table["component"], tuple(table.get("structure", {}).items()))
    travel = spring.solid_travel - spring.compress(force)
    found = {
        "spring_rate": spring.rate(force),
        "surge_frequency": float(spring.surge_frequencies(force)[0]),
        "preload": force,
        "wire_stress": float((spring.stress_by_force * spring.is_open(force)).max()),
        "wire_amplitude": spring.fatigue.amplitude,
        "wire_strength": spring.fatigue.mean,
    }
    if segments := component.structure.get("segments"):
        found |= {f"gap[{i}]": gap for i, gap in enumerate(map(float, spring.cut(force, segments)), 1)}
    else:
        found["clash_clearance"] = travel
        if "clash_stiffness" not in given:
            found["clash_stiffness"] = CLOSED_COILS
    note = (
        f"its wire gives {found['spring_rate'] / 1e3:.4g} N/mm, {found['surge_frequency']:.4g} Hz, "
        f"{force:.4g} N installed ({found['wire_stress'] * force / MPA:.4g} MPa), "
        f"{1e3 * travel:.4g} mm until all coils touch"
    )
    return Inserted({name: WithUnit(value) for name, value in found.items()}, notes=[note])


def replace_rate(table: dict[str, Any]) -> None:
    """Take what a wire gives out of a component's table that gets one."""
    parameters = table.get("parameters")
    if isinstance(parameters, dict):
        kept = {name: value for name, value in parameters.items() if name.partition("[")[0] not in FOUND}
        table["parameters"] = kept
