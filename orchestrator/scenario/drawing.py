"""The drawing of a shaft in a scenario, which becomes the modes of the component `shaft`."""

import math
from typing import Annotated, Any

from pydantic import Field, ValidationError

from models.valve_train.beam import (
    Bearing,
    Disc,
    Modes,
    Shaft,
    find_bending,
    find_torsion,
    list_parameters,
    rigid_bending,
)

from .fields import Table, in_unit
from .messages import place_faults
from .values import Faults, Inserted

Length = Annotated[float, in_unit("m")]
Place = Annotated[float, in_unit("m", zero=True)]
Inertia = Annotated[float, in_unit("kg.m2")]
InertiaOr0 = Annotated[float, in_unit("kg.m2", zero=True)]
Mass = Annotated[float, in_unit("kg", zero=True)]
TurningStiffness = Annotated[float, in_unit("N.m/rad")]
Time = Annotated[float, in_unit("s", zero=True)]
Ratio = Annotated[float, in_unit("1", zero=True)]
Modulus = Annotated[float, in_unit("Pa")]
Density = Annotated[float, in_unit("kg/m3")]


class CamDrawing(Table):
    """A cam, as a disc on the shaft."""

    place: Place = Field(description="Distance from the driven end (m)")
    inertia: Inertia = Field(1.2e-4, description="Moment of inertia about the shaft (kg m2)")
    mass: Mass = Field(0.1, description="Mass (kg)")
    transverse_inertia: InertiaOr0 = Field(0.7e-4, description="Moment of inertia about a diameter (kg m2)")


class ShaftDrawing(Table):
    """A round shaft, driven at one end. Without bearings and journals it does not bend."""

    length: Length = Field(description="Length (m)")
    diameter: Length = Field(description="Diameter (m)")
    bore: Place = Field(0.0, description="Diameter of the bore (m)")
    cams: list[CamDrawing] = Field(description="Cams, in the order of their numbers", min_length=1)
    bearings: list[Place] = Field([], description="Distances of pinned bearings from the driven end (m)")
    journals: list[Place] = Field(
        [], description="Distances of journals from the driven end (m), which have the numbers after the cams"
    )
    drive_stiffness: TurningStiffness | None = Field(
        None,
        description="Stiffness of belt, chain or gears between drive and shaft (N m/rad); left out: rigid",
    )
    damping_time: Time = Field(0.0, description="Damping over stiffness (s)")
    damping_ratio: Ratio = Field(0.02, description="Damping ratio of every mode, added to it")
    modes: int = Field(3, description="Lowest modes of torsion and of bending, besides static shapes", ge=1)
    youngs_modulus: Modulus = Field(207e9, description="Young's modulus (Pa)")
    poissons_ratio: Ratio = Field(0.3, description="Poisson's ratio")
    density: Density = Field(7850.0, description="Density (kg/m3)")


def insert_drawing(table: dict[str, Any]) -> Inserted:
    """The modes of the table's `drawing`."""
    try:
        drawing = ShaftDrawing.model_validate(table["drawing"])
    except ValidationError as error:
        raise place_faults("drawing", error, list(ShaftDrawing.model_fields)) from None
    torsion, bending = find_modes(drawing)
    parameters = list_parameters(torsion, bending, drawing.damping_time, drawing.damping_ratio)
    sizes = {
        "cams": len(drawing.cams) + len(drawing.journals),
        "torsion_modes": torsion.frequency.size,
        "bending_modes": bending.frequency.size,
    }
    return Inserted(parameters, sizes)


def find_modes(drawing: ShaftDrawing) -> tuple[Modes, Modes]:
    """Of torsion and of bending; Faults for places beyond the shaft, and for bearings that do not hold it."""
    for i, cam in enumerate(drawing.cams):
        if cam.place > drawing.length:
            raise Faults((f"drawing.cams[{i + 1}].place", f" = {cam.place:g} m: must be <= length"))
    for name, places in (("bearings", drawing.bearings), ("journals", drawing.journals)):
        for i, place in enumerate(places):
            if place > drawing.length:
                raise Faults((f"drawing.{name}[{i + 1}]", f" = {place:g} m: must be <= length"))
    if drawing.bore >= drawing.diameter:
        raise Faults(("drawing.bore", f" = {drawing.bore:g} m: must be < diameter = {drawing.diameter:g} m"))
    shaft = Shaft(
        drawing.length,
        drawing.diameter,
        [Disc(c.place, c.mass, c.inertia, c.transverse_inertia) for c in drawing.cams],
        [Bearing(place) for place in drawing.bearings],
        drawing.bore,
        drawing.youngs_modulus,
        drawing.poissons_ratio,
        drawing.density,
        drive_stiffness=drawing.drive_stiffness or math.inf,
        journals=drawing.journals,
    )
    torsion = find_torsion(shaft, drawing.modes)
    if not drawing.bearings and not drawing.journals:
        return torsion, rigid_bending(len(drawing.cams))
    try:
        return torsion, find_bending(shaft, drawing.modes)
    except ValueError as error:
        raise Faults(("drawing.bearings", f": {error}")) from None
